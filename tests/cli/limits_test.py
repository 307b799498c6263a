#!/usr/bin/env python3
"""Tests of the command line as users meet it: ends of a run before its time, and parts of a picture made apart."""
import json
import os
import signal
import struct
import subprocess
import time

import program
from program import environment, exr_attributes, exr_pixels, png_pixels, png_size, ProgramTest, Running, main


class Signals(ProgramTest):
    def check_signal(self, number):
        running = Running(self, "-o", "a.png", "-o", "a.exr", "--checkpoint", "a.checkpoint", "--stats", "a.json")
        running.process.send_signal(number)
        self.assertEqual(running.end(), 5)
        self.assertIn("interrupted", running.lines[-1])
        self.assertEqual(png_size((self.folder / "a.png").read_bytes()), (64, 48))
        self.assertGreater(max(png_pixels((self.folder / "a.png").read_bytes())), 30)
        statistics = self.json("a.json")
        self.assertEqual(statistics["stop"], "interrupted")
        self.assertGreaterEqual(statistics["samples_done"], 2)
        frame = json.loads(self.ok("info", "--json", "a.checkpoint").out)
        self.assertEqual(frame["samples_done"], statistics["samples_done"])

    def test_interrupt_writes_picture_and_checkpoint(self):
        self.check_signal(signal.SIGINT)

    def test_termination_writes_picture_and_checkpoint(self):
        self.check_signal(signal.SIGTERM)

    def test_second_interrupt_leaves_at_once(self):
        # One pass with so many light samples takes minutes, and longer than the grace that the first interrupt gives.
        process = subprocess.Popen([program.PROGRAM, "render", "builtin:cornell", "--size", "2000x2000", "--spp", "1", "--light-samples", "4096",
                                    "--max-bounces", "0", "-o", "a.png", "--progress", "json"], cwd=self.folder, stdin=subprocess.DEVNULL,
                                   stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, env=environment())
        self.addCleanup(process.stderr.close)
        while b'"render"' not in (line := process.stderr.readline()):
            self.assertTrue(line)
        process.send_signal(signal.SIGINT)
        time.sleep(0.3)
        self.assertIsNone(process.poll())
        started = time.monotonic()
        process.send_signal(signal.SIGINT)
        self.assertEqual(process.wait(30), 5)
        self.assertLess(time.monotonic() - started, 4)
        self.assertEqual(self.files(), [])

    def test_an_interrupted_run_goes_on(self):
        running = Running(self, "-o", "a.exr", "--checkpoint", "a.checkpoint")
        running.process.send_signal(signal.SIGINT)
        self.assertEqual(running.end(), 5)
        done = json.loads(self.ok("info", "--json", "a.checkpoint").out)["samples_done"]
        target = str(done + 3)
        self.ok("render", "builtin:cornell", "--size", "64x48", "--spp", target, "--resume", "a.checkpoint", "-o", "b.exr")
        self.ok("render", "builtin:cornell", "--size", "64x48", "--spp", target, "-o", "c.exr")
        self.assertEqual(exr_pixels((self.folder / "b.exr").read_bytes()), exr_pixels((self.folder / "c.exr").read_bytes()))


class Limits(ProgramTest):
    """Without their limit, these would take hours; how much later than the limit a loaded machine ends is not looked at."""

    def test_time_limit(self):
        self.ok("render", "builtin:cornell", "--size", "200x150", "--spp", "100000000", "--time-limit", "1.5", "-o", "a.png", "--stats", "a.json")
        statistics = self.json("a.json")
        self.assertEqual(statistics["stop"], "time-limit")
        self.assertGreater(statistics["samples_done"], 0)
        self.assertGreater(statistics["seconds"]["total"], 0.5)

    def test_time_limit_within_a_long_pass(self):
        """The first pass alone would take minutes: the tiles that are done make the picture."""
        self.ok("render", "builtin:cornell", "--size", "1500x1500", "--spp", "1", "--light-samples", "4096", "--max-bounces", "0", "--time-limit", "2",
                "-o", "a.jpg", "--stats", "a.json", timeout=60)
        self.assertEqual(self.json("a.json")["stop"], "time-limit")

    def test_time_limit_before_any_pixel(self):
        self.fails(4, "render", "builtin:cornell", "--size", "1500x1500", "--spp", "1", "--light-samples", "65536", "--max-bounces", "0", "--time-limit",
                   "1e-6", "-o", "a.png", says="time limit")
        self.assertEqual(self.files(), [])

    def test_target_error(self):
        self.ok("render", "builtin:cornell", "--size", "32x24", "--spp", "100000000", "--target-error", "0.2", "-o", "a.png", "--stats", "a.json")
        statistics = self.json("a.json")
        self.assertEqual(statistics["stop"], "target-error")
        self.assertLessEqual(statistics["image"]["estimated_relative_error"], 0.2)

    def test_samples_are_the_first_limit(self):
        self.render("--target-error", "1e-9", "--time-limit", "600", "-o", "a.png", "--stats", "a.json", spp=3)
        self.assertEqual(self.json("a.json")["stop"], "samples")

    def test_memory_limit_refuses_before_allocating(self):
        for limit, arguments in (("0.5", ("builtin:cornell", "--size", "16000x16000", "--aov", "all")),
                                 ("0.1", ("builtin:isosurface,triangles=10000000", "--size", "16x16"))):
            process = subprocess.Popen([program.PROGRAM, "render", *arguments, "--memory-limit", limit, "-o", "a.exr"], cwd=self.folder,
                                       stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, env=environment())
            message = process.stderr.read().decode()
            process.stderr.close()
            _, status, usage = os.wait4(process.pid, 0)
            process.returncode = os.waitstatus_to_exitcode(status)
            self.assertEqual(process.returncode, 4, message)
            self.assertEqual(message.count("\n"), 1, message)
            self.assertIn("GiB", message)
            self.assertLess(usage.ru_maxrss, 400 << 10)
        self.assertEqual(self.files(), [])

    def test_memory_limit_counts_everything_together(self):
        """Each part alone would fit; the message names them."""
        scene = "builtin:isosurface,triangles=200000"
        self.render("-o", "a.png", "--stats", "a.json", "--aov", "all", scene=scene, size="640x480", spp=1)
        memory = self.json("a.json")["memory"]
        parts = [memory["scene_bytes"], memory["accel_bytes"], memory["frame_bytes"]]
        limited = ("--size", "640x480", "--spp", "1", "--aov", "all", "--threads", "1", "-o", "b.png", "--memory-limit")
        gib = 1 << 30
        self.fails(4, "render", scene, *limited, 0.98 * (parts[0] + parts[1]) / gib + parts[2] / gib, says="--memory-limit")
        # The light image, and the tables of a visibility.
        small = ("builtin:cornell", "--size", "640x480", "--spp", "2", "--threads", "1", "-o", "b.png", "--memory-limit")
        self.ok("render", *small, 0.032)
        self.fails(4, "render", *small, 0.032, "--method", "bidirectional", says=("scene", "picture"))
        self.fails(4, "render", *small, 0.1, "--visibility", "cached", "--set", "shared_table_bits=25", says=("picture", "visibility", "0.10 GiB"))
        self.ok("render", *small, 0.2, "--visibility", "cached", "--set", "shared_table_bits=25")

    def test_a_picture_larger_than_the_machine_is_refused(self):
        self.fails(4, "render", "builtin:cornell", "--size", "46000x46000", "--aov", "all", "-o", "a.exr", says="GiB")


class Slices(ProgramTest):
    FORMATS = ("a.exr", "a.hdr", "a.png")

    def test_slices_add_up_to_one_run(self):
        whole = [argument for name in self.FORMATS for argument in ("-o", name)]
        self.render(*whole, "--aov", "all", spp=7)
        for a, b in ((0, 3), (3, 4), (4, 7)):
            self.render("--sample-range", f"{a}:{b}", "--aov", "all", "-o", f"{a}.slice", spp=7)
        self.ok("merge", "4.slice", "0.slice", "3.slice", "-o", "m.exr", "-o", "m.hdr", "-o", "m.png")
        self.ok("merge", "0.slice", "3.slice", "-o", "03.slice")
        self.ok("merge", "4.slice", "03.slice", "-o", "n.exr")
        read = lambda name: (self.folder / name).read_bytes()
        self.assertEqual(exr_pixels(read("a.exr")), exr_pixels(read("m.exr")))
        self.assertEqual(exr_pixels(read("a.exr")), exr_pixels(read("n.exr")))
        self.assertEqual(read("a.hdr"), read("m.hdr"))
        self.assertEqual(read("a.png"), read("m.png"))
        self.assertIn("sightline.version", exr_attributes(read("m.exr")))

    def test_slices_that_do_not_fit_are_refused(self):
        self.render("--sample-range", "0:2", "-o", "0.slice", spp=4)
        self.render("--sample-range", "1:4", "-o", "1.slice", spp=4)
        self.render("--sample-range", "2:4", "-o", "seed.slice", "--seed", "3", spp=4)
        self.render("--sample-range", "2:4", "-o", "box.slice", "--filter", "box", spp=4)
        self.render("--sample-range", "2:4", "-o", "layers.slice", "--aov", "depth", spp=4)
        self.fails(2, "merge", "0.slice", "1.slice", "-o", "m.exr", says="overlap")
        for other in ("seed.slice", "box.slice"):
            self.fails(2, "merge", "0.slice", other, "-o", "m.exr", says="different pictures")
        self.fails(2, "merge", "0.slice", "layers.slice", "-o", "m.exr", says="layers.slice")
        self.fails(3, "merge", "0.slice", "missing.slice", "-o", "m.exr", says="missing.slice")
        self.fails(2, "merge", "0.slice", "-o", "m.tiff", says="m.tiff")
        self.assertFalse((self.folder / "m.exr").exists())

    def test_checkpoint_and_resume_give_the_same_bits(self):
        self.render("-o", "a.exr", "-o", "a.png", spp=9)
        self.render("-o", "b.exr", "--checkpoint", "c", spp=4)
        self.render("-o", "b.exr", "-o", "b.png", "--resume", "c", "--checkpoint", "c", spp=9)
        self.assertEqual(exr_pixels((self.folder / "a.exr").read_bytes()), exr_pixels((self.folder / "b.exr").read_bytes()))
        self.assertEqual((self.folder / "a.png").read_bytes(), (self.folder / "b.png").read_bytes())

    def test_a_foreign_checkpoint_is_refused(self):
        self.render("-o", "a.exr", "--checkpoint", "c", spp=4)
        small = ("--spp", "8", "-o", "b.exr", "--resume", "c")
        self.fails(2, "render", "builtin:cornell", "--size", "32x25", *small, says=("c: ", "another picture"))
        self.fails(2, "render", "builtin:furnace", "--size", "32x24", *small, says="another picture")
        self.fails(2, "render", "builtin:cornell", "--size", "32x24", "--seed", "4", *small, says="another picture")
        self.fails(2, "render", "builtin:cornell", "--size", "32x24", "--smooth-terminator", *small, says="another picture")
        self.fails(2, "render", "builtin:cornell", "--size", "32x24", "--aov", "depth", *small, says="layers")
        (self.folder / "c").write_bytes(b"SLFRAME1 but not really one, only as long as it must be.....")
        self.fails(3, "render", "builtin:cornell", "--size", "32x24", *small, says="c: ")
        self.fails(3, "render", "builtin:cornell", "--size", "32x24", "--spp", "8", "-o", "b.exr", "--resume", "missing", says="missing")


class Sequences(ProgramTest):
    def test_frames(self):
        self.render("--frames", "0-3x2", "-o", "f####.png", "--stats", "f##.json")
        self.assertEqual(self.files(), ["f00.json", "f0000.png", "f0002.png", "f02.json"])

    def test_one_frame(self):
        self.render("--frame", "12", "-o", "f###.png")
        self.assertEqual(self.files(), ["f012.png"])

    def test_frames_need_different_names(self):
        self.fails(2, "render", "builtin:cornell", "--frames", "0-1", "-o", "a.png", says="####")
        self.fails(2, "render", "builtin:cornell", "--frames", "0-1", "-o", "a##.png", "--checkpoint", "c", says="####")

    def test_skip_existing(self):
        self.render("--frames", "0-2", "-o", "f#.png")
        old = (self.folder / "f1.png").stat().st_mtime_ns
        (self.folder / "f2.png").unlink()
        self.render("--frames", "0-3", "-o", "f#.png", "--skip-existing")
        self.assertEqual(self.files(), [f"f{n}.png" for n in range(4)])
        self.assertEqual((self.folder / "f1.png").stat().st_mtime_ns, old)

    def test_an_interrupted_frame_does_not_pass_for_a_complete_one(self):
        running = Running(self, "--frames", "0-1", "-o", "f#.png", "--checkpoint", "c#")
        running.process.send_signal(signal.SIGINT)
        self.assertEqual(running.end(), 5)
        self.assertEqual(self.files(), ["c0"])

    def test_moving_objects_move(self):
        positions = b"".join(struct.pack("<3f", *p) for p in ((-1, -1, 0), (1, -1, 0), (0, 1, 0)))
        times = struct.pack("<2f", 0, 1) + struct.pack("<6f", 0, 0, 0, 1, 0, 0)
        (self.folder / "a.bin").write_bytes(positions + times)
        document = {
            "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 1]}],
            "nodes": [{"mesh": 0}, {"camera": 0, "translation": [0, 0, 4]}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "cameras": [{"type": "perspective", "perspective": {"yfov": 0.8, "znear": 0.1}}],
            "animations": [{"channels": [{"sampler": 0, "target": {"node": 0, "path": "translation"}}], "samplers": [{"input": 1, "output": 2}]}],
            "buffers": [{"uri": "a.bin", "byteLength": 68}],
            "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 32}],
            "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0]},
                          {"bufferView": 1, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0], "max": [1]},
                          {"bufferView": 1, "byteOffset": 8, "componentType": 5126, "count": 2, "type": "VEC3"}]}
        (self.folder / "a.gltf").write_text(json.dumps(document))
        self.render("--frames", "0-24x12", "-o", "f##.png", scene="a.gltf")
        pictures = [(self.folder / f"f{n:02}.png").read_bytes() for n in (0, 12, 24)]
        self.assertEqual(len(set(pictures)), 3)
        # A frame of a sequence is the frame alone.
        self.render("--frame", "12", "-o", "alone.png", scene="a.gltf")
        self.assertEqual((self.folder / "alone.png").read_bytes(), pictures[1])


if __name__ == "__main__":
    main(globals())
