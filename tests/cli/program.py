"""Runs the program and reads what it makes; shared by the tests of the command line.

Usage of each of them: NAME_test.py PROGRAM [CLASS...], or NAME_test.py --expect-groups CLASS...
"""
import json
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

# Set by main().
PROGRAM = None

COMMANDS = ("render", "compare", "methods", "info", "bench", "gallery", "merge")


class Run:
    def __init__(self, completed):
        self.code = completed.returncode
        self.out = completed.stdout
        self.err = completed.stderr.decode(errors="replace")

    @property
    def lines(self):
        return self.err.splitlines()


def environment(**changes):
    """Our own settings must not leak into the tests."""
    env = {key: value for key, value in os.environ.items() if key not in ("SIGHTLINE_DATA", "NO_COLOR")}
    env.update(changes)
    return env


class ProgramTest(unittest.TestCase):
    """A test case with a folder of its own."""

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="sightline-test-"))
        self.addCleanup(shutil.rmtree, self.folder, True)

    def run_program(self, *arguments, timeout=120, env=None, **options):
        options.setdefault("stdout", subprocess.PIPE)
        completed = subprocess.run([PROGRAM, *map(str, arguments)], stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, timeout=timeout,
                                   cwd=self.folder, env=env or environment(), **options)
        return Run(completed)

    def ok(self, *arguments, **options):
        run = self.run_program(*arguments, **options)
        self.assertEqual(run.code, 0, run.err)
        return run

    def fails(self, code, *arguments, says=(), **options):
        """Exit code, one line on stderr, and what that line must contain."""
        run = self.run_program(*arguments, **options)
        self.assertEqual(run.code, code, f"{arguments}: {run.err}")
        errors = [line for line in run.lines if not line.startswith("warning: ")]
        self.assertEqual(len(errors), 1, f"{arguments}: {run.err}")
        self.assertTrue(errors[0].startswith("sightline: "), errors[0])
        self.assertNotIn("internal error", errors[0])
        for text in [says] if isinstance(says, str) else says:
            self.assertIn(text, errors[0])
        return run

    def render(self, *arguments, scene="builtin:cornell", size="32x24", spp=2, threads=1, **options):
        return self.ok("render", scene, "--size", size, "--spp", spp, "--threads", threads, *arguments, **options)

    def json(self, name):
        return json.loads((self.folder / name).read_text())

    def files(self):
        return sorted(path.name for path in self.folder.iterdir())


class Running:
    """A render that would take very long, once its first samples are in."""

    def __init__(self, test, *arguments, scene="builtin:cornell"):
        self.process = subprocess.Popen([PROGRAM, "render", scene, "--size", "64x48", "--spp", "100000000", "--progress", "json", *arguments],
                                        cwd=test.folder, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, env=environment())
        test.addCleanup(self.process.stderr.close)
        test.addCleanup(self.process.wait)
        test.addCleanup(self.process.kill)
        self.lines = []
        while True:
            line = self.process.stderr.readline().decode()
            if not line:
                raise AssertionError("ended early: " + "".join(self.lines))
            self.lines.append(line)
            if line.startswith("{") and json.loads(line).get("spp", 0) >= 2:
                return

    def end(self, timeout=30):
        self.lines += self.process.stderr.read().decode().splitlines(keepends=True)
        return self.process.wait(timeout)


def exr_header_end(data):
    at = 8
    while data[at]:
        for _ in range(2):
            at = data.index(b"\0", at) + 1
        at += 4 + struct.unpack_from("<I", data, at)[0]
    return at + 1


def exr_attributes(data):
    """Name to (type, bytes)."""
    at, attributes = 8, {}
    while data[at]:
        end = data.index(b"\0", at)
        name, at = data[at:end].decode(), end + 1
        end = data.index(b"\0", at)
        kind, at = data[at:end].decode(), end + 1
        size = struct.unpack_from("<I", data, at)[0]
        attributes[name] = (kind, data[at + 4:at + 4 + size])
        at += 4 + size
    return attributes


def exr_channels(data):
    body, at, names = exr_attributes(data)["channels"][1], 0, []
    while body[at]:
        end = body.index(b"\0", at)
        names.append(body[at:end].decode())
        at = end + 1 + 16
    return names


def exr_pixels(data):
    """The packed pixel blocks, which do not depend on the header (the offsets between them do)."""
    attributes = exr_attributes(data)
    x0, y0, x1, y1 = struct.unpack("<4i", attributes["dataWindow"][1])
    lines = {0: 1, 1: 1, 2: 1, 3: 16, 4: 32}[attributes["compression"][1][0]]
    blocks = -(-(y1 - y0 + 1) // lines)
    return data[exr_header_end(data) + 8 * blocks:]


def png_size(data):
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    return struct.unpack(">II", data[16:24])


def png_pixels(data):
    """Inflated rows with their filter bytes: enough to see whether a picture is black."""
    at, packed = 8, b""
    while at < len(data):
        size, kind = struct.unpack_from(">I4s", data, at)
        if kind == b"IDAT":
            packed += data[at + 8:at + 8 + size]
        at += 12 + size
    return zlib.decompress(packed)


def main(module):
    """Runs the test classes of `module` (its globals()) that the command line names, or checks that it names all of them."""
    groups = sorted(name for name, value in module.items() if isinstance(value, type) and issubclass(value, ProgramTest) and value is not ProgramTest)
    if sys.argv[1] == "--expect-groups":
        sys.exit(0 if groups == sorted(sys.argv[2:]) else f"CMakeLists.txt lists {sorted(sys.argv[2:])}, this file has {groups}")
    global PROGRAM
    PROGRAM = os.path.abspath(sys.argv[1])
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]], verbosity=1)
