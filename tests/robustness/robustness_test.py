#!/usr/bin/env python3
"""The program itself on damaged files. Usage: robustness_test.py [--sanitized] PROGRAM [CLASS...]"""
import concurrent.futures
import os
import pathlib
import resource
import subprocess
import sys
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "cli"))
import program  # noqa: E402
from program import ProgramTest, environment  # noqa: E402

SANITIZED = False
ADDRESS_SPACE = 3 << 30
SECONDS = 20


def limits():
    # The sanitizers reserve address space without end.
    if not SANITIZED:
        resource.setrlimit(resource.RLIMIT_AS, (ADDRESS_SPACE, ADDRESS_SPACE))


def examine(path, folder, command=("info",)):
    """None, or what is wrong with how the program took the file."""
    try:
        completed = subprocess.run([program.PROGRAM, *command, str(path), "--threads", "1"], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, timeout=SECONDS * (10 if SANITIZED else 1), env=environment(), preexec_fn=limits)
    except subprocess.TimeoutExpired:
        return f"{path}: takes longer than {SECONDS} s"
    lines = completed.stderr.decode(errors="replace").splitlines()
    errors = [line for line in lines if line.startswith("sightline: ")]
    if completed.returncode == 0:
        return None if not errors else f"{path}: exit 0 with {errors}"
    if completed.returncode != 3:
        return f"{path}: exit {completed.returncode}: {lines[-3:]}"
    if len(errors) != 1 or lines[-1] != errors[0]:
        return f"{path}: not one line: {lines[-3:]}"
    if pathlib.Path(path).name not in errors[0]:
        return f"{path}: the file is not named: {errors[0]}"
    return None


class RobustnessTest(ProgramTest):
    def examine_all(self, paths, command=("info",)):
        with concurrent.futures.ThreadPoolExecutor(min(4, len(os.sched_getaffinity(0)))) as pool:
            problems = [problem for problem in pool.map(lambda path: examine(path, self.folder, command), paths) if problem]
        self.assertEqual(problems, [], f"{len(problems)} of {len(paths)}:\n" + "\n".join(problems))


class Damaged(RobustnessTest):
    def seeds(self):
        subprocess.run([sys.executable, str(HERE.parent / "fuzz" / "make_corpus.py"), "seeds"], cwd=self.folder, check=True)
        self.render("-o", "seeds/small.slice", "-o", "seeds/small.exr", "-o", "seeds/small.jpg", size="8x8")
        return sorted(path for path in (self.folder / "seeds").rglob("*") if path.is_file())

    def test_cut_and_garbled_files(self):
        paths = []
        for seed in self.seeds():
            data = seed.read_bytes()
            self.assertIsNone(examine(seed, self.folder))
            for part in (0, 0.02, 0.3, 0.6, 0.97):
                path = seed.with_name(f"cut-{part}-{seed.name}")
                path.write_bytes(data[:int(part * len(data))])
                paths.append(path)
            for part in (0.05, 0.5, 0.9):
                at = int(part * len(data))
                path = seed.with_name(f"garbled-{part}-{seed.name}")
                path.write_bytes(data[:at] + bytes([data[at] ^ 0xFF, 0xFF]) + data[at + 2:])
                paths.append(path)
        self.examine_all(paths)

    def test_damaged_files_end_a_render_with_3(self):
        self.seeds()
        for name in ("gltf/triangle.glb", "ply/binary_little_endian.ply"):
            data = (self.folder / "seeds" / name).read_bytes()
            cut = self.folder / ("cut" + pathlib.Path(name).suffix)
            cut.write_bytes(data[:len(data) // 2])
            self.fails(3, "render", cut.name, "-o", "a.png", "--size", "8x8", says=cut.name)
        (self.folder / "cut.hdr").write_bytes((self.folder / "seeds/image_hdr/rle.hdr").read_bytes()[:70])
        self.fails(3, "render", "builtin:cornell", "--environment", "cut.hdr", "-o", "a.png", "--size", "8x8", says="cut.hdr")
        self.assertFalse((self.folder / "a.png").exists())

    def test_files_that_are_none(self):
        (self.folder / "empty.gltf").write_bytes(b"")
        (self.folder / "text.exr").write_text("this is no picture\n")
        (self.folder / "name with\nline.ply").write_text("ply\n")
        for name in ("empty.gltf", "text.exr", "name with\nline.ply"):
            self.fails(3, "info", name)


class Foreign(RobustnessTest):
    """Hostile files that others collected, where there are any."""

    def test_every_file(self):
        root = pathlib.Path(os.environ.get("SIGHTLINE_DATA") or "/nonexistent") / "malformed"
        self.examine_all(sorted(path for path in root.rglob("*") if path.is_file()))


if __name__ == "__main__":
    arguments = sys.argv[1:]
    if arguments[0] == "--sanitized":
        SANITIZED = True
        arguments = arguments[1:]
    program.PROGRAM = os.path.abspath(arguments[0])
    unittest.main(argv=[sys.argv[0], *arguments[1:]], verbosity=1)
