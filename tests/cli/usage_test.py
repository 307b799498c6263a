#!/usr/bin/env python3
"""Tests of the command line as users meet it: what can be typed and what is answered to it."""
import itertools
import json
import os
import pty
import subprocess

import program
from program import COMMANDS, environment, exr_pixels, ProgramTest, main


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
                         --environment-rotate --environment-mapping --light-area --light-point --light-directional --material --spp --light-samples
                         --max-bounces --seed --threads --frame --frames --fps --target-error --sample-range --skip-existing --time-limit
                         --memory-limit --checkpoint --resume --aov --exposure --tonemap --filter --simd --stats --progress --verbose
                         --quiet --log-level --smooth-terminator""".split():
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
        for threads in (1, 7, 64):
            self.assertEqual(self.render("-o", "a.png", "-q", threads=threads).err, "")


class Names(ProgramTest):
    """A wrong name is answered with the nearest right one."""

    def check(self, *arguments, says):
        self.fails(2, "render", *arguments, "--size", "8x8", "--spp", "1", "-o", "a.exr", says=says)

    def test_method(self):
        self.check("builtin:cornell", "--method", "referense", says="'reference'")
        self.fails(2, "methods", "referense", says="'reference'")

    def test_what_methods_describes(self):
        self.fails(2, "methods", "cachd", says="'cached'")
        self.fails(2, "methods", "shadowmap", "--json", says="'shadow-map'")
        self.fails(2, "methods", "zzz", says=("reference", "bidirectional", "exact", "nee++", "shadow-map"))

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


if __name__ == "__main__":
    main(globals())
