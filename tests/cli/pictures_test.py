#!/usr/bin/env python3
"""Tests of the command line as users meet it: files that are written, and those that cannot be."""
import json
import os
import stat
import struct
import subprocess
import time

import program
from program import environment, exr_attributes, exr_channels, exr_pixels, png_pixels, png_size, ProgramTest, main


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

    def write_pfm(self, name, width, height, value):
        rows = (value(x, y) for y in reversed(range(height)) for x in range(width))
        (self.folder / name).write_bytes(b"PF\n%d %d\n-1.0\n" % (width, height) + b"".join(struct.pack("<3f", v, v, v) for v in rows))

    def test_environment_turns_with_the_frames(self):
        self.write_pfm("sky.pfm", 32, 16, lambda x, y: 20.0 if (x, y) == (9, 5) else 0.3)
        light = ("--environment", "sky.pfm", "-q")
        scene = "builtin:pair,vertices=2000"
        self.render("-o", "turned-####.pfm", "--frames", "0-4x2", "--environment-turn", "20", *light, scene=scene)
        for frame, degrees in ((0, 0), (2, 40), (4, 80)):
            self.render("-o", "rotated.pfm", "--frame", frame, "--environment-rotate", degrees, *light, scene=scene)
            self.assertEqual((self.folder / f"turned-{frame:04}.pfm").read_bytes(), (self.folder / "rotated.pfm").read_bytes(), frame)

    def test_environment_as_a_cube(self):
        # Face +Y alone is bright: the same as a cube file, and the same again when it is made into a cube of its own size.
        self.write_pfm("cube.pfm", 2, 12, lambda x, y: 3.0 if 4 <= y < 6 else 0.0)
        scene = "builtin:pair,vertices=2000"
        light = ("--environment", "cube.pfm", "--environment-mapping", "cube", "-q")
        self.render("-o", "a.pfm", *light, scene=scene)
        self.render("-o", "b.pfm", *light, "--environment-cube", "2", scene=scene)
        self.render("-o", "c.pfm", *light, "--environment-cube", "6", scene=scene)
        a, b, c = ((self.folder / name).read_bytes() for name in ("a.pfm", "b.pfm", "c.pfm"))
        self.assertEqual(a, b)
        self.assertNotEqual(a, c)  # other samples of the same light
        means = [json.loads(self.ok("info", "--json", name).out)["channels"][0]["mean"] for name in ("a.pfm", "c.pfm")]
        self.assertGreater(means[0], 0.1)
        self.assertAlmostEqual(means[0], means[1], delta=0.05 * means[0])
        self.write_pfm("strip.pfm", 2, 10, lambda x, y: 1.0)
        self.fails(3, "render", scene, "-o", "d.pfm", "--environment", "strip.pfm", "--environment-mapping", "cube", says=("six square faces",))
        self.fails(2, "render", scene, "-o", "d.pfm", "--no-default-light", "--environment-cube", "4", says=("no environment",))
        self.fails(2, "render", scene, "-o", "d.pfm", "--environment-cube", "0")

    def test_alpha_is_coverage(self):
        # A square that fills half of the view, lit by a white environment.
        (self.folder / "half.obj").write_text("v -9 -9 0\nv 0 -9 0\nv 0 9 0\nv -9 9 0\nf 1 2 3 4\n")
        view = ("--eye", "0,0,5", "--target", "0,0,0", "--aov", "alpha", "-q")
        self.render("-o", "a.exr", "-o", "a.png", "-o", "a.jpg", "-o", "a.slice", *view, scene="half.obj", size="16x4")
        self.assertEqual(exr_channels((self.folder / "a.exr").read_bytes())[:4], ["A", "B", "G", "R"])
        alpha = [channel for channel in json.loads(self.ok("info", "--json", "a.exr").out)["channels"] if channel["name"] == "A"][0]
        self.assertEqual((alpha["minimum"], alpha["maximum"]), (0, 1))
        self.assertAlmostEqual(alpha["mean"], 0.5, delta=0.05)
        channels = json.loads(self.ok("info", "--json", "a.png").out)["channels"]
        self.assertEqual([channel["name"] for channel in channels], ["R", "G", "B", "A"])
        self.assertAlmostEqual(channels[3]["mean"], 0.5, delta=0.05)
        # Environment and surface alike stay in the colour, which PNG does not multiply by alpha.
        self.assertGreater(channels[0]["minimum"], 0.3)
        self.ok("merge", "a.slice", "-o", "m.png")
        self.assertEqual((self.folder / "m.png").read_bytes(), (self.folder / "a.png").read_bytes())
        self.render("-o", "b.png", "--aov", "depth")
        self.assertEqual(len(json.loads(self.ok("info", "--json", "b.png").out)["channels"]), 3)

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


if __name__ == "__main__":
    main(globals())
