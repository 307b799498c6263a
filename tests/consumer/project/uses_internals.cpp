// Must not compile: the folders of src/ are not part of the package.
#include <base/core/context.h>

int main() { return sightline::usable_cpu_count(); }
