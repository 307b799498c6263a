#!/usr/bin/env python3
"""Tests of the command line as users meet it: what a run says about itself, and comparisons of pictures."""
import json
import math
import re

from program import exr_attributes, png_size, ProgramTest, main


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


if __name__ == "__main__":
    main(globals())
