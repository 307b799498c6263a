#!/usr/bin/env python3
"""Tests of the command line as users meet it. Usage: cli_test.py PROGRAM [CLASS...]; cli_test.py --expect-groups CLASS..."""
import itertools
import json
import math
import os
import pathlib
import pty
import re
import signal
import stat
import struct
import subprocess
import sys
import time
import unittest

import program
from program import ProgramTest, environment, exr_attributes, exr_channels, exr_pixels, png_pixels, png_size

COMMANDS = ("render", "compare", "methods", "info", "bench", "gallery", "merge")


class Usage(ProgramTest):
    def test_version_is_one_line(self):
        self.assertRegex(self.ok("--version").out.decode(), r"^sightline \d+\.\d+\.\d+\S*\n$")

    def test_help_names_every_command(self):
        text = self.ok("--help").out.decode()
        for command in COMMANDS:
            self.assertIn(command, text)

    def test_every_command_has_help(self):
        for command in COMMANDS:
            run = self.ok(command, "--help")
            self.assertIn("--threads", run.out.decode(), command)
            self.assertEqual(run.err, "")

    def test_help_of_render_names_every_documented_option(self):
        text = self.ok("render", "--help").out.decode()
        for option in """--output --method --set --visibility --size --camera --eye --target --up --fov --environment --environment-scale
                         --environment-rotate --environment-mapping --light-area --light-point --light-directional --spp --light-samples
                         --max-bounces --seed --threads --frame --frames --fps --target-error --sample-range --skip-existing --time-limit
                         --memory-limit --checkpoint --resume --aov --exposure --tonemap --filter --simd --stats --progress --verbose
                         --quiet --log-level""".split():
            self.assertIn(option, text)

    def test_wrong_usage_is_2_with_one_line(self):
        self.fails(2)
        self.fails(2, "rendr", says="'render'")
        self.fails(2, "render", "builtin:cornell", "--exposre", "3", "-o", "a.exr", says="'--exposure'")
        self.fails(2, "render", "builtin:cornell", says="--output")
        self.fails(2, "render", "-o", "a.exr", says="SCENE")
        self.fails(2, "compare", "a.exr")
        for size in ("0x4", "4", "4x", "axb", "-3x4", "99999x4", "65536x65536", "1e9x1"):
            self.fails(2, "render", "builtin:cornell", "--size", size, "-o", "a.exr")
        for option, value in (("--spp", "0"), ("--spp", "x"), ("--spp", "-1"), ("--max-bounces", "-1"), ("--time-limit", "0"), ("--time-limit", "-1"),
                              ("--target-error", "0"), ("--memory-limit", "nope"), ("--fov", "0"), ("--fov", "180"), ("--threads", "-1"),
                              ("--eye", "1,2"), ("--eye", "1,2,x"), ("--eye", "1,2,nan"), ("--sample-range", "3:3"), ("--sample-range", "3"),
                              ("--frames", "3-1"), ("--frames", "x"), ("--light-point", "1,2,3"), ("--light-area", "0,0,0 0,0,0 1x1 1,1,1"),
                              ("--set", "nothing"), ("--fps", "0"), ("--seed", "x"), ("--progress", "sometimes"), ("--log-level", "loud")):
            self.fails(2, "render", "builtin:cornell", option, value, "-o", "a.exr")
        self.fails(2, "render", "builtin:cornell", "--spp", "4", "--sample-range", "2:5", "--size", "4x4", "-o", "a.slice", says="--sample-range")
        self.fails(2, "render", "builtin:cornell", "--up", "0,1,0", "--size", "4x4", "-o", "a.exr", says="--eye")
        self.assertEqual(self.files(), [])

    def test_options_and_scene_in_any_order(self):
        arguments = [["builtin:cornell"], ["--size", "16x12"], ["-o", "a.exr"], ["--spp", "1"], ["--set", "mode=path"]]
        pictures = set()
        for order in list(itertools.permutations(arguments))[::9]:
            self.ok("render", *sum(order, []))
            pictures.add(exr_pixels((self.folder / "a.exr").read_bytes()))
        self.assertEqual(len(pictures), 1)
        self.ok("render", "--output=b.exr", "--size=16x12", "--spp=1", "--set=mode=path", "builtin:cornell")
        self.assertIn(exr_pixels((self.folder / "b.exr").read_bytes()), pictures)

    def test_negative_numbers_are_values(self):
        self.render("--eye", "-1,2,-3", "--target", "-0.5,-.25,0", "--up", "-1,1,0", "--exposure", "-1.5", "-o", "a.exr", "--seed", "7")
        self.render("--eye=-1,2,-3", "--target=-0.5,-.25,0", "--up=-1,1,0", "-o", "b.exr", "--seed", "7")
        self.assertEqual(exr_pixels((self.folder / "a.exr").read_bytes()), exr_pixels((self.folder / "b.exr").read_bytes()))
        self.render("--light-directional", "-1,-1,-1 1,1,1", "--light-point", "-1,2,-3 5,5,5", "-o", "c.exr")

    def test_several_scenes_are_merged(self):
        one = json.loads(self.ok("info", "--json", "builtin:cornell").out)
        self.render("builtin:cornell", "-o", "a.png", "--stats", "a.json")
        self.assertEqual(self.json("a.json")["scene"]["triangles"], 2 * one["triangles"])

    def test_both_forms_of_scene_parameters(self):
        a = json.loads(self.ok("info", "--json", "builtin:hairball,triangles=3000").out)
        b = json.loads(self.ok("info", "--json", "builtin:hairball?triangles=3000").out)
        self.assertEqual(a["triangles"], b["triangles"])

    def on_terminal(self, **env):
        """What a terminal would be sent by a run that warns (there is no light)."""
        (self.folder / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        master, slave = pty.openpty()
        process = subprocess.Popen([program.PROGRAM, "render", "a.obj", "--size", "8x8", "--spp", "1", "-o", "a.png"], cwd=self.folder,
                                   stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=slave, env=environment(TERM="xterm", **env))
        os.close(slave)
        text = b""
        try:
            while piece := os.read(master, 65536):
                text += piece
        except OSError:  # the other end is closed
            pass
        os.close(master)
        self.assertEqual(process.wait(60), 0)
        return text.decode()

    def test_colour_only_on_terminals_that_want_it(self):
        self.assertIn("\033[33mwarning:", self.on_terminal())
        plain = self.on_terminal(NO_COLOR="1")
        self.assertIn("warning:", plain)
        self.assertNotIn("\033[33m", plain)
        run = self.ok("render", "a.obj", "--size", "8x8", "--spp", "1", "-o", "a.png")
        self.assertIn("warning:", run.err)
        self.assertNotIn("\033", run.err)

    def test_quiet_says_nothing(self):
        self.assertEqual(self.render("-o", "a.png", "-q").err, "")


class Names(ProgramTest):
    """A wrong name is answered with the nearest right one."""

    def check(self, *arguments, says):
        self.fails(2, "render", *arguments, "--size", "8x8", "--spp", "1", "-o", "a.exr", says=says)

    def test_method(self):
        self.check("builtin:cornell", "--method", "referense", says="'reference'")
        self.fails(2, "methods", "referense", says="'reference'")

    def test_visibility(self):
        self.check("builtin:cornell", "--visibility", "exakt", says="'exact'")

    def test_setting(self):
        self.check("builtin:cornell", "--set", "mod=path", says="'mode'")

    def test_choice_of_a_setting(self):
        self.check("builtin:cornell", "--set", "mode=pth", says="path")

    def test_layer(self):
        self.check("builtin:cornell", "--aov", "albdo", says="'albedo'")

    def test_builtin(self):
        self.check("builtin:cornel", says="cornell")
        self.fails(2, "info", "builtin:cornel", says="cornell")

    def test_builtin_parameter(self):
        self.check("builtin:hairball,triangels=5", says="triangles")

    def test_camera(self):
        self.check("builtin:cornell", "--camera", "nobody", says="camera")

    def test_filter_tonemap_mapping_metric_simd(self):
        self.check("builtin:cornell", "--filter", "gausian", says="gaussian")
        self.check("builtin:cornell", "--tonemap", "acess", says="aces")
        (self.folder / "e.pfm").write_bytes(b"PF\n2 1\n-1.0\n" + bytes(24))
        self.check("builtin:cornell", "--environment", "e.pfm", "--environment-mapping", "latlon", says="latlong")
        self.fails(2, "compare", "e.pfm", "e.pfm", "--fail-over", "pnsr=3", says="psnr")
        self.check("builtin:cornell", "--simd", "AVX9", says="AVX2")


class Pictures(ProgramTest):
    def test_every_format(self):
        self.render("-o", "a.exr", "-o", "a.hdr", "-o", "a.pfm", "-o", "a.png", "-o", "a.jpg", "-o", "a.jpeg", "-o", "A.PNG", "-o", "a.slice")
        data = {name: (self.folder / name).read_bytes() for name in self.files()}
        self.assertEqual(data["a.exr"][:4], b"\x76\x2f\x31\x01")
        self.assertTrue(data["a.hdr"].startswith(b"#?RADIANCE"))
        self.assertTrue(data["a.pfm"].startswith(b"PF\n32 24\n"))
        self.assertEqual(png_size(data["a.png"]), (32, 24))
        self.assertEqual(data["a.png"], data["A.PNG"])
        self.assertEqual(data["a.jpg"][:3], b"\xff\xd8\xff")
        self.assertEqual(data["a.jpg"], data["a.jpeg"])
        self.assertTrue(data["a.slice"].startswith(b"SLFRAME"))
        self.assertGreater(max(png_pixels(data["a.png"])), 30)

    def test_exr_header_tells_how_it_was_made(self):
        self.render("-o", "a.exr", "--seed", "5")
        attributes = exr_attributes((self.folder / "a.exr").read_bytes())
        for name in ("version", "command", "scene_hash", "seed", "samples", "method", "seconds", "peak_memory_bytes", "worldToCamera", "worldToNDC",
                     "statistics"):
            self.assertIn("sightline." + name, attributes)
        self.assertIn("chromaticities", attributes)
        self.assertEqual(attributes["sightline.seed"][1], b"5")
        self.assertIn(b"render builtin:cornell", attributes["sightline.command"][1])

    def test_layers(self):
        self.render("-o", "a.exr", "--aov", "all")
        channels = exr_channels((self.folder / "a.exr").read_bytes())
        for layer in ("albedo", "normal", "position", "depth", "surface", "direct", "indirect", "variance"):
            self.assertTrue(any(name.startswith(layer + ".") for name in channels), f"{layer}: {channels}")
        self.render("-o", "b.exr")
        self.assertEqual(exr_channels((self.folder / "b.exr").read_bytes())[:3], ["B", "G", "R"])

    def test_standard_output(self):
        self.render("-o", "a.exr", "-o", "a.png", "-o", "a.hdr")
        for name in ("exr", "png", "hdr"):
            run = self.render("-o", name + ":-")
            expected = (self.folder / ("a." + name)).read_bytes()
            if name == "exr":
                self.assertEqual(exr_pixels(run.out), exr_pixels(expected))
            else:
                self.assertEqual(run.out, expected)

    def test_any_number_of_threads_gives_the_same_pixels(self):
        for threads in (1, 2, 7):
            self.render("-o", f"{threads}.exr", "-o", f"{threads}.png", "--aov", "all", "--stats", f"{threads}.json", threads=threads, size="70x40")
            self.assertEqual(self.json(f"{threads}.json")["threads"], threads)
        for threads in (2, 7):
            self.assertEqual(exr_pixels((self.folder / "1.exr").read_bytes()), exr_pixels((self.folder / f"{threads}.exr").read_bytes()))
            self.assertEqual((self.folder / "1.png").read_bytes(), (self.folder / f"{threads}.png").read_bytes())

    def test_seed_changes_the_noise(self):
        self.render("-o", "a.png", "--seed", "1")
        self.render("-o", "b.png", "--seed", "2")
        self.assertNotEqual((self.folder / "a.png").read_bytes(), (self.folder / "b.png").read_bytes())

    def test_exposure_and_tone_map_leave_linear_outputs_alone(self):
        self.render("-o", "a.hdr", "-o", "a.png")
        self.render("-o", "b.hdr", "-o", "b.png", "--exposure", "2", "--tonemap", "filmic")
        self.assertEqual((self.folder / "a.hdr").read_bytes(), (self.folder / "b.hdr").read_bytes())
        self.assertNotEqual((self.folder / "a.png").read_bytes(), (self.folder / "b.png").read_bytes())


class Outputs(ProgramTest):
    """What cannot be written is known before the work starts, or ends in 4 without half a file."""

    LONG = ("--size", "64x64", "--spp", "100000000")

    def test_refused_before_the_work(self):
        started = time.monotonic()
        self.fails(2, "render", "builtin:cornell", *self.LONG, "-o", "a.tiff", says="exr")
        self.fails(2, "render", "builtin:cornell", *self.LONG, "-o", "noending", says="exr")
        self.fails(2, "render", "builtin:cornell", *self.LONG, "-o", "missing/a.exr", says="missing")
        self.fails(2, "render", "builtin:cornell", *self.LONG, "-o", "a.exr", "--stats", "missing/a.json", says="missing")
        self.fails(2, "render", "builtin:cornell", *self.LONG, "-o", "a.exr", "--checkpoint", "missing/a.slice", says="missing")
        self.fails(2, "render", "builtin:cornell", *self.LONG, "-o", "exr:-", "--stats", "-", says="standard output")
        self.fails(2, "render", "builtin:cornell", *self.LONG, "-o", "a.exr", "-o", "a.exr", says="twice")
        (self.folder / "folder.exr").mkdir()
        self.fails(2, "render", "builtin:cornell", *self.LONG, "-o", "folder.exr", says="folder")
        self.assertLess(time.monotonic() - started, 60)

    def test_unwritable_places(self):
        # Root may write anywhere but where the file system itself says no.
        self.fails(4, "render", "builtin:cornell", "--size", "16x12", "--spp", "1", "-o", "/proc/sightline.exr", says="/proc/sightline.exr")
        if os.geteuid() != 0:
            locked = self.folder / "locked"
            locked.mkdir()
            locked.chmod(stat.S_IRUSR | stat.S_IXUSR)
            self.fails(4, "render", "builtin:cornell", *self.LONG, "-o", "locked/a.exr", says="locked/a.exr")

    def test_full_disk(self):
        (self.folder / "full.exr").symlink_to("/dev/full")
        self.fails(4, "render", "builtin:cornell", "--size", "16x12", "--spp", "1", "-o", "full.exr", says="No space left")
        self.assertEqual(self.files(), ["full.exr"])
        with open("/dev/full", "wb") as full:
            self.fails(4, "render", "builtin:cornell", "--size", "16x12", "--spp", "1", "-o", "exr:-", stdout=full, says="standard output")
            self.fails(4, "methods", "--json", stdout=full, says="standard output")
            self.fails(4, "info", "builtin:cornell", stdout=full, says="standard output")

    def test_one_failed_output_does_not_cost_the_others(self):
        (self.folder / "full.exr").symlink_to("/dev/full")
        self.fails(4, "render", "builtin:cornell", "--size", "16x12", "--spp", "1", "-o", "full.exr", "-o", "a.png", "--stats", "a.json", says="/dev/full")
        self.assertEqual(png_size((self.folder / "a.png").read_bytes()), (16, 12))
        self.assertEqual(self.json("a.json")["stop"], "samples")

    def test_a_checkpoint_that_fails_is_a_warning(self):
        (self.folder / "full.slice").symlink_to("/dev/full")
        run = self.render("-o", "a.png", "--checkpoint", "full.slice")
        self.assertIn("warning: the checkpoint is not saved", run.err)
        self.assertTrue((self.folder / "a.png").exists())

    def test_killed_while_writing_leaves_no_partial_file(self):
        """SIGKILL at many moments of writing a large picture: the name holds nothing or the whole."""
        (self.folder / "small.exr").write_bytes(b"old")
        arguments = [program.PROGRAM, "render", "builtin:furnace", "--size", "800x600", "--spp", "1", "--max-bounces", "0", "-o", "small.exr",
                     "-o", "big.pfm", "--threads", "2"]
        started = time.monotonic()
        subprocess.run(arguments, cwd=self.folder, check=True, capture_output=True, env=environment())
        whole = time.monotonic() - started
        size = (self.folder / "big.pfm").stat().st_size
        for step in range(8):
            (self.folder / "big.pfm").unlink(missing_ok=True)
            (self.folder / "small.exr").write_bytes(b"old")
            process = subprocess.Popen(arguments, cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env=environment())
            time.sleep(whole * (0.3 + 0.1 * step))
            process.kill()
            process.wait()
            if (self.folder / "big.pfm").exists():
                self.assertEqual((self.folder / "big.pfm").stat().st_size, size)
            exr = (self.folder / "small.exr").read_bytes()
            if exr != b"old":
                self.ok("info", "small.exr")

    def test_a_reader_that_leaves_is_no_bug(self):
        read_end, write_end = os.pipe()
        os.close(read_end)
        run = self.run_program("methods", "--json", stdout=write_end)
        os.close(write_end)
        self.assertEqual(run.code, 4)
        self.assertEqual(run.err, "")

    def test_output_through_a_link_replaces_the_file(self):
        (self.folder / "real.png").write_bytes(b"old")
        (self.folder / "link.png").symlink_to("real.png")
        self.render("-o", "link.png")
        self.assertTrue((self.folder / "link.png").is_symlink())
        self.assertEqual(png_size((self.folder / "real.png").read_bytes()), (32, 24))


class Running:
    """A render that would take very long, once its first samples are in."""

    def __init__(self, test, *arguments, scene="builtin:cornell"):
        self.process = subprocess.Popen([program.PROGRAM, "render", scene, "--size", "64x48", "--spp", "100000000", "--progress", "json", *arguments],
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


class Statistics(ProgramTest):
    KEYS = {
        "sightline": str, "method": str, "settings": dict, "scene": {"triangles": int, "instances": int, "lights": int}, "size": list, "threads": int,
        "simd": str,
        "seconds": {"load": float, "build": float, "prepare": float, "render": float, "write": float, "total": float, "stages": dict},
        "rays": {"closest": int, "occlusion": int}, "visibility": {"queries": int, "traced": int, "cached": int, "lookups": int, "rejected": int, "residual": int, "filling": int,
                       "filling_seconds": float, "answered_at_depth": list},
        "memory": {"peak_rss_bytes": int, "scene_bytes": int, "accel_bytes": int, "bake_bytes": int},
        "image": {"mean_luminance": float, "nonfinite_pixels": int}, "method_statistics": dict,
        # Beyond the list that all methods share.
        "spp": int, "samples_done": int, "stop": str, "seed": int}

    def check_keys(self, keys, value, place=""):
        for key, kind in keys.items():
            self.assertIn(key, value, place)
            if isinstance(kind, dict):
                self.check_keys(kind, value[key], f"{place}.{key}")
            else:
                self.assertIsInstance(value[key], (int, float) if kind is float else kind, f"{place}.{key}")

    def test_keys(self):
        self.render("-o", "a.exr", "--stats", "a.json")
        statistics = self.json("a.json")
        self.check_keys(self.KEYS, statistics)
        self.assertEqual(statistics["size"], [32, 24])
        self.assertGreater(statistics["rays"]["closest"], 0)
        self.assertGreater(statistics["image"]["mean_luminance"], 0)
        self.assertEqual(statistics["image"]["nonfinite_pixels"], 0)
        seconds = statistics["seconds"]
        parts = sum(seconds[key] for key in ("load", "build", "prepare", "render", "write"))
        self.assertLessEqual(parts, seconds["total"] * 1.001 + 1e-3)
        self.assertGreaterEqual(statistics["memory"]["peak_rss_bytes"], statistics["memory"]["scene_bytes"])
        # The EXR's header says the same.
        header = json.loads(exr_attributes((self.folder / "a.exr").read_bytes())["sightline.statistics"][1])
        self.check_keys(self.KEYS, header)
        self.assertEqual(header["rays"], statistics["rays"])

    def test_standard_output(self):
        self.check_keys(self.KEYS, json.loads(self.render("-o", "a.png", "--stats", "-").out))

    def test_simd_is_pinned_and_recorded(self):
        for name in ("AVX2", "SSSE3"):
            run = self.run_program("render", "builtin:cornell", "--size", "16x12", "--spp", "1", "--simd", name, "-o", "a.png", "--stats", "a.json")
            if run.code == 0:
                self.assertEqual(self.json("a.json")["simd"], name)
            else:
                # This machine lacks it.
                self.assertEqual(run.code, 2)

    def test_settings_are_recorded(self):
        self.render("-o", "a.png", "--stats", "a.json", "--set", "mode=path")
        self.assertEqual(self.json("a.json")["settings"]["mode"], "path")


class Progress(ProgramTest):
    def test_json_lines_parse(self):
        run = self.ok("render", "builtin:cornell", "--size", "64x48", "--spp", "100000000", "--time-limit", "1.5", "-o", "a.png", "--progress", "json",
                      "--log-level", "error")
        lines = [json.loads(line) for line in run.lines]
        self.assertGreater(len(lines), 2)
        for line in lines:
            self.assertIsInstance(line["phase"], str)
            self.assertTrue(0 <= line["percent"] <= 100)
            self.assertGreater(line["bytes"], 0)
        rendered = [line for line in lines if "spp" in line]
        self.assertGreater(rendered[-1]["rays_per_second"], 0)
        self.assertGreater(rendered[-1]["eta"], 0)
        self.assertEqual([line["spp"] for line in rendered], sorted(line["spp"] for line in rendered))

    def test_none_and_plain(self):
        self.assertEqual(self.render("-o", "a.png", "--progress", "none", "--log-level", "error").err, "")
        run = self.render("-o", "a.png", "--progress", "plain")
        self.assertNotIn("\r", run.err)


class Compare(ProgramTest):
    METRICS = ("mse", "rmse", "relmse", "nmse", "l2", "linf", "psnr", "ssim", "flip", "hdrflip")

    def setUp(self):
        super().setUp()
        self.render("-o", "ref.exr", "--aov", "surface", spp=16)
        self.render("-o", "a.exr", "--seed", "1", spp=2)
        self.render("-o", "b.exr", "--seed", "1", spp=8)

    def test_json(self):
        result = json.loads(self.ok("compare", "ref.exr", "a.exr", "b.exr", "--json", "-").out)
        self.assertEqual(result["reference"], "ref.exr")
        self.assertEqual([image["file"] for image in result["images"]], ["a.exr", "b.exr"])
        for image in result["images"]:
            for metric in self.METRICS:
                self.assertIsInstance(image["metrics"][metric], (int, float), metric)
        a, b = (image["metrics"] for image in result["images"])
        self.assertLess(b["mse"], a["mse"])
        self.assertGreater(b["psnr"], a["psnr"])
        self.assertTrue(math.isclose(a["rmse"]**2, a["mse"], rel_tol=1e-5))

    def test_equal_pictures(self):
        self.ok("compare", "ref.exr", "ref.exr", "--json", "a.json")
        metrics = self.json("a.json")["images"][0]["metrics"]
        self.assertIsNone(metrics["psnr"])
        self.assertEqual(metrics["mse"], 0)
        self.assertAlmostEqual(metrics["ssim"], 1)

    def test_report_and_difference(self):
        self.ok("compare", "ref.exr", "a.exr", "--html", "r.html", "--difference", "d.png")
        self.assertEqual(png_size((self.folder / "d.png").read_bytes()), (32, 24))
        page = (self.folder / "r.html").read_text()
        self.assertIn("a.exr", page)
        self.assertIsNone(re.search(r"""(src|href)=["']https?:""", page))

    def test_mask(self):
        everything = json.loads(self.ok("compare", "ref.exr", "a.exr", "--json", "-").out)["images"][0]["metrics"]
        masked = json.loads(self.ok("compare", "ref.exr", "a.exr", "--json", "-", "--mask").out)["images"][0]["metrics"]
        self.assertNotEqual(everything["mse"], masked["mse"])
        self.fails(2, "compare", "a.exr", "ref.exr", "--mask", says="surface")

    def test_fail_over(self):
        self.ok("compare", "ref.exr", "a.exr", "--fail-over", "mse=1e9", "--fail-over", "psnr=1")
        run = self.run_program("compare", "ref.exr", "a.exr", "--fail-over", "mse=1e-9", "--json", "-")
        self.assertEqual(run.code, 6)
        self.assertIn("mse", run.err)
        self.assertIn("images", json.loads(run.out))
        self.assertEqual(self.run_program("compare", "ref.exr", "a.exr", "--fail-over", "psnr=99").code, 6)
        self.ok("compare", "ref.exr", "ref.exr", "--fail-over", "psnr=99")
        self.fails(2, "compare", "ref.exr", "a.exr", "--fail-over", "mse", says="METRIC=VALUE")

    def test_pictures_that_do_not_fit(self):
        self.render("-o", "c.exr", size="32x25")
        self.fails(3, "compare", "ref.exr", "c.exr", says=("c.exr", "32x25"))
        self.fails(3, "compare", "ref.exr", "missing.exr", says="missing.exr")
        self.fails(2, "compare", "ref.exr", "a.exr", "--html", "missing/r.html", says="missing")


class Methods(ProgramTest):
    def test_a_setting_described_once_appears_everywhere(self):
        listing = json.loads(self.ok("methods", "--json").out)
        self.assertIn("reference", [method["name"] for method in listing["methods"]])
        self.assertIn("exact", [visibility["name"] for visibility in listing["visibilities"]])
        for kind in ("methods", "visibilities"):
            for entry in listing[kind]:
                self.assertEqual(json.loads(self.ok("methods", entry["name"], "--json").out)["settings"], entry["settings"])
                text = self.ok("methods", entry["name"]).out.decode()
                for setting in entry["settings"]:
                    self.assertIn(setting["help"], text)
                    default = setting["default"]
                    shown = str(default).lower() if isinstance(default, bool) else str(default)
                    self.assertIn(f"{setting['name']}={shown}", text)

    def test_visibilities_state_their_facts(self):
        facts = {entry["name"]: entry for entry in json.loads(self.ok("methods", "--json").out)["visibilities"]}
        for name, entry in facts.items():
            self.assertEqual(json.loads(self.ok("methods", name, "--json").out), entry)
            text = self.ok("methods", name).out.decode()
            self.assertIn(entry["help"], text)
            self.assertIn(entry["citation"], text)
            stated = text.splitlines()[1].strip().split(", ")
            for fact in ("binary", "unbiased", "deterministic"):
                self.assertIn(fact if entry[fact] else f"not {fact}", stated, name)
            self.assertIn(name, self.ok("methods").out.decode())
        self.assertTrue(facts["exact"]["unbiased"] and facts["exact"]["binary"])
        self.assertFalse(facts["shadow-map"]["unbiased"])
        self.assertTrue(facts["nee++"]["unbiased"])
        self.assertFalse(facts["nee++"]["binary"])

    def test_every_setting_of_a_visibility_can_be_set(self):
        for visibility in json.loads(self.ok("methods", "--json").out)["visibilities"]:
            for setting in visibility["settings"]:
                for value in setting.get("choices", [setting["default"]]):
                    text = str(value).lower() if isinstance(value, bool) else str(value)
                    self.ok("render", "builtin:cornell", "--visibility", visibility["name"], "--set", f"{setting['name']}={text}", "--size", "8x8",
                            "--spp", "2", "-o", "a.png", "--stats", "a.json")
                    statistics = self.json("a.json")
                    self.assertEqual(statistics["visibility_name"], visibility["name"])
                    self.assertEqual(str(statistics["settings"][setting["name"]]), str(value))

    def test_every_setting_can_be_set(self):
        for method in json.loads(self.ok("methods", "--json").out)["methods"]:
            for setting in method["settings"]:
                values = setting.get("choices", [setting["default"]])
                for value in values:
                    text = str(value).lower() if isinstance(value, bool) else str(value)
                    self.ok("render", "builtin:cornell", "--method", method["name"], "--set", f"{setting['name']}={text}", "--size", "8x8", "--spp", "2",
                            "-o", "a.png", "--stats", "a.json")
                    self.assertEqual(self.json("a.json")["settings"][setting["name"]], value)

    def test_documentation_names_every_method_and_option(self):
        docs = pathlib.Path(__file__).resolve().parents[2] / "docs"
        text = "\n".join(page.read_text() for page in docs.rglob("*.md"))
        for method in json.loads(self.ok("methods", "--json").out)["methods"]:
            self.assertIn(f"`{method['name']}`", text)
        for visibility in json.loads(self.ok("methods", "--json").out)["visibilities"]:
            self.assertIn(f"`{visibility['name']}`", text)
        page = (docs / "cli.md").read_text()
        for command in COMMANDS:
            self.assertIn(f"`{command}", page)
        for option in set(re.findall(r"--[a-z][a-z-]+", self.ok("render", "--help").out.decode())):
            if option not in ("--help", "--help-all"):
                self.assertIn(option, page)


class Info(ProgramTest):
    def test_scene(self):
        scene = json.loads(self.ok("info", "--json", "builtin:cornell").out)
        self.assertEqual(scene["kind"], "scene")
        for key in ("triangles", "bounds", "materials", "lights", "cameras", "warnings", "animation_seconds"):
            self.assertIn(key, scene)
        self.assertIn("triangles", self.ok("info", "builtin:cornell").out.decode())

    def test_picture_and_slice(self):
        self.render("-o", "a.exr", "-o", "a.png", "-o", "a.hdr", "-o", "a.slice", "--aov", "depth")
        exr = json.loads(self.ok("info", "--json", "a.exr").out)
        self.assertEqual(exr["size"], [32, 24])
        self.assertIn("depth.Z", [channel["name"] for channel in exr["channels"]])
        self.assertEqual(exr["metadata"]["sightline.statistics"]["method"], "reference")
        slice_ = json.loads(self.ok("info", "--json", "a.slice").out)
        self.assertEqual((slice_["kind"], slice_["samples_done"]), ("frame", 2))
        several = json.loads(self.ok("info", "--json", "a.png", "a.hdr").out)
        self.assertEqual([entry["size"] for entry in several], [[32, 24], [32, 24]])

    def test_builtin_scenes(self):
        text = self.ok("info", "builtin:").out.decode()
        listing = json.loads(self.ok("info", "--json", "builtin:").out)
        for scene in listing["scenes"]:
            self.assertIn("builtin:" + scene["name"], text)
        self.assertIn("triangles", [scene for scene in listing["scenes"] if scene["name"] == "hairball"][0]["parameters"])

    def test_missing_files(self):
        self.fails(3, "info", "missing.gltf", says="missing.gltf")
        self.fails(3, "info", "missing.exr", says="missing.exr")
        self.fails(3, "render", "missing.obj", "-o", "a.exr", says="missing.obj")
        self.fails(3, "info", ".", says=".")
        self.fails(3, "render", "missing\nname.obj", "-o", "a.exr", says="missing")


class Bench(ProgramTest):
    SMALL = ("bench", "visibility-cache", "--quick", "--view", "builtin:cornell", "--size", "48x40", "--threads", 2)

    def test_all_parts_of_the_visibility_cache_suite(self):
        self.ok(*self.SMALL, "--ce", "8", "--spp", "1,2", "--json", "a.json", "--markdown", "a.md", "--html", "a.html", "--strip", "a.png")
        results = self.json("a.json")
        self.assertEqual((results["suite"], results["threads"], results["quick"], results["interrupted"]), ("visibility-cache", 2, True, False))
        curves = results["curves"][0]
        self.assertEqual((curves["view"], curves["size"]), ("builtin:cornell", [48, 40]))
        self.assertEqual([sample["spp"] for sample in curves["samples"]], [1, 2])
        rows = [row for sample in curves["samples"] for row in sample["cached"]] + results["ablations"][0]["rows"]
        for row in rows:
            self.assertGreater(row["share_traced"], 0, row)
            self.assertLessEqual(row["share_traced"], 1, row)
            for key in ("linf", "flip", "l2", "signed_error", "seconds", "speed_up", "lookups_per_query"):
                self.assertTrue(math.isfinite(row[key]), (key, row))
            self.assertLess(abs(row["signed_error"]), row["linf"] + 1e-9)
            self.assertLess(row["linf"], 0.5, row)
            self.assertAlmostEqual(row["ray_reduction"], 1 / row["share_traced"] - 1, 6)
        equal_time = results["equal_time"][0]["rows"]
        self.assertEqual(len(equal_time), 5)
        self.assertTrue(all(math.isfinite(row["linf"]) and row["spp"] >= 1 and row["light_samples"] >= 1 for row in equal_time))
        self.assertEqual(results["shadow_maps"], [])
        lookup = results["lookup"][0]
        self.assertGreater(lookup["exact"]["bare_mray_per_s"], 0)
        for row in lookup["rows"]:
            self.assertGreater(row["ns_per_query"], 0)
            self.assertGreater(row["misses"], 0)
        self.assertEqual([row["visibility"] for row in lookup["frames"]], ["exact", "cached", "cached"])
        self.assertTrue(all(0 < row["visibility_share"] <= 1.01 for row in lookup["frames"]))
        depth_0, refined = lookup["rows"][:2]
        self.assertEqual(depth_0["lookups_per_query"], 1)
        self.assertGreater(refined["lookups_per_query"], 1)
        self.assertLessEqual(0, results["flicker"][0]["flicker"])
        self.assertLess(results["flicker"][0]["flicker"], 0.5)
        self.assertEqual(png_size((self.folder / "a.png").read_bytes()), (6 * 24, 3 * 20))
        page = (self.folder / "a.html").read_text()
        self.assertGreaterEqual(page.count("<svg"), 9)
        self.assertNotRegex(page, r"(src|href)=\"(?!data:)")
        self.assertIn("### Ablations", (self.folder / "a.md").read_text())

    def test_one_part_alone(self):
        results = json.loads(self.ok(*self.SMALL, "--part", "flicker", "--json", "-").out)
        self.assertEqual([key for key in ("curves", "equal_time", "shadow_maps", "lookup", "flicker", "ablations") if results[key]], ["flicker"])

    def test_wrong_names_and_missing_data(self):
        self.fails(2, "bench", "visibility-cach", says="visibility-cache")
        self.fails(2, "bench", "visibility-cache", "--part", "curve", says="curves")
        self.fails(2, "bench", "visibility-cache", "--view", "sponza-curt", says="sponza-court")
        self.fails(2, "bench", "visibility-cache", "--ce", "0")
        self.fails(2, "bench", "visibility-cache", "--spp", "1,x")
        self.fails(2, "bench", "trace", "--part", "curves", says="visibility-cache")
        self.fails(2, "bench", "visibility-cache", "--json", "missing/a.json", says="missing")
        run = self.ok("bench", "visibility-cache", "--view", "kitchen", "--data", ".", "--json", "-")
        self.assertIn("kitchen", run.err)
        self.assertEqual(json.loads(run.out)["curves"], [])


def groups():
    return sorted(name for name, value in globals().items() if isinstance(value, type) and issubclass(value, ProgramTest) and value is not ProgramTest)


if __name__ == "__main__":
    if sys.argv[1] == "--expect-groups":
        sys.exit(0 if groups() == sorted(sys.argv[2:]) else f"CMakeLists.txt lists {sorted(sys.argv[2:])}, this file has {groups()}")
    program.PROGRAM = os.path.abspath(sys.argv[1])
    unittest.main(argv=[sys.argv[0], *sys.argv[2:]], verbosity=1)
