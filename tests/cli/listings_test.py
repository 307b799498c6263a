#!/usr/bin/env python3
"""Tests of the command line as users meet it: methods, files and benchmarks described."""
import json
import math
import pathlib
import re

from program import COMMANDS, png_size, ProgramTest, main


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

    def test_bakes(self):
        self.ok("bake", "builtin:cornell", "--method", "square-lights", "--bake-dir", "bakes")
        bakes = sorted(self.folder.glob("bakes/*.bake"))
        self.assertTrue(bakes)
        content = bakes[0].read_bytes()
        (self.folder / "a.bake").write_bytes(content)
        bake = json.loads(self.ok("info", "--json", "a.bake").out)
        self.assertEqual((bake["kind"], bake["bytes"], bake["damage"]), ("bake", len(content), None))
        self.assertTrue(bake["of"].startswith("square-lights."))
        self.assertEqual(bakes[0].name, bake["of"] + "-" + bake["key"] + ".bake")
        self.assertGreater(bake["sections"][0]["bytes"], 0)
        # Damage is shown, and is malformed input.
        (self.folder / "a.bake").write_bytes(content[:-200] + b"x" + content[-199:])
        damaged = self.fails(3, "info", "--json", "a.bake", says="damaged")
        self.assertIn(True, [section["damaged"] for section in json.loads(damaged.out)["sections"]])
        (self.folder / "a.bake").write_bytes(content[:200])
        self.fails(3, "info", "a.bake", says="cut short")

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
        for part, option in (("lookup,rivals", ("--ce", "8")), ("flicker", ("--spp", "4")), ("curves", ("--strip", "a.png"))):
            self.fails(2, "bench", "visibility-cache", "--part", part, *option, says=(option[0], "--part"))
        self.fails(2, "bench", "trace", "--ce", "8", says="visibility-cache")
        self.fails(2, "bench", "visibility-cache", "--json", "missing/a.json", says="missing")
        run = self.ok("bench", "visibility-cache", "--view", "kitchen", "--data", ".", "--json", "-")
        self.assertIn("kitchen", run.err)
        self.assertEqual(json.loads(run.out)["curves"], [])

    TRACE = ("bench", "trace", "--quick", "--view", "builtin:cornell", "--size", "64x48", "--threads", 2)

    def test_both_parts_of_the_trace_suite(self):
        run = self.ok(*self.TRACE, "--json", "a.json", "--markdown", "a.md")
        self.assertIn("bounce rays", run.err)
        results = self.json("a.json")
        self.assertEqual((results["suite"], results["threads"], results["quick"], results["interrupted"]), ("trace", 2, True, False))
        view = results["views"][0]
        self.assertEqual([row["rays"] for row in view["tracer"]], ["primary", "shadow", "bounce"])
        self.assertEqual(len(view["pictures"]), 3)
        for row in view["tracer"] + view["pictures"]:
            self.assertEqual(row["rounds"], 1)
        # A slice of the samples more or less would show here.
        for row in view["pictures"]:
            self.assertAlmostEqual(row["product_rays"] / row["bare_rays"], 1, delta=0.1)
        self.assertEqual((self.folder / "a.md").read_text().count("| builtin:cornell |"), 6)

    def test_one_part_of_the_trace_suite(self):
        view = json.loads(self.ok(*self.TRACE, "--part", "rays", "--rounds", 2, "--json", "-").out)["views"][0]
        self.assertEqual([row["rounds"] for row in view["tracer"]], [2, 2, 2])
        self.assertEqual(view["pictures"], [])
        self.fails(2, "bench", "trace", "--part", "picture", says="pictures")

    def test_all_parts_of_the_fragments_suite(self):
        run = self.ok("bench", "fragments", "--quick", "--view", "builtin:half-plane,light=area,light_size=1", "--size", "64x48", "--threads", 2, "--truth-samples", 128,
                "--cache-dir", "kept", "--json", "a.json", "--markdown", "a.md", "--html", "a.html", "--strip", "a.png")
        # Settings of all candidates are known.
        self.assertNotIn("left out", run.err)
        results = self.json("a.json")
        self.assertEqual((results["suite"], results["threads"], results["quick"], results["interrupted"]), ("fragments", 2, True, False))
        table = results["table"][0]
        self.assertEqual((table["size"], table["truth_samples"]), ([64, 48], 128))
        rows = {row["name"]: row for row in table["rows"]}
        ours, monte_carlo = table["rows"][0], rows["Monte Carlo, 64 samples"]
        self.assertEqual([row["key"] for row in table["rows"]][:4], ["default", "koa", "nichols", "monte-carlo-64"])
        self.assertGreaterEqual(len(rows), 14)
        for row in rows.values():
            for key in ("seconds", "speed_up", "l2", "nmse", "flip", "psnr", "rays"):
                self.assertTrue(math.isfinite(row[key]), (key, row))
            self.assertLess(row["l2"], 0.3, row)
            if row is monte_carlo:
                self.assertIsNone(row["fragments"])
                continue
            parts = [row[key] or 0 for key in ("test_rays", "confirmation_rays", "level0_rays", "extra_rays", "penumbra_rays", "other_rays")]
            self.assertEqual(sum(parts), row["rays"], row)
            self.assertGreaterEqual(row["other_rays"], 0, row)
            self.assertLess(row["level0_share"], 1, row)
            self.assertTrue(all(seconds >= 0 for seconds in row["stages"].values()) and row["stages"]["visibility"] > 0, row)
        self.assertLess(ours["rays"], monte_carlo["rays"])
        self.assertEqual(monte_carlo["speed_up"], 1)
        self.assertEqual(rows["no confirmation"]["confirmation_rays"], 0)
        self.assertEqual(rows["no additional samples"]["extra_rays"], 0)
        self.assertEqual([row["threshold"] for row in table["nichols_sweep"]], [4, 16])
        curve = results["curve"][0]
        self.assertEqual([row["samples"] for row in curve["rows"]], [4, 16, 64])
        errors = [row["l2"] for row in curve["rows"]]
        self.assertEqual(errors, sorted(errors, reverse=True))
        self.assertGreater(curve["equal_error"]["ratio"], 0)
        for part in ("table", "sizes", "interactive"):
            self.assertEqual(results[part][0]["view"], "builtin:half-plane,light=area,light_size=1")
        self.assertEqual([row["side"] for row in results["sizes"][0]["rows"]], [1, 3.5])
        path = results["interactive"][0]
        self.assertEqual((path["path"], path["frames"]), ("court walk", 6))
        self.assertGreater(path["frames_per_second"], 0)
        self.assertEqual(png_size((self.folder / "a.png").read_bytes()), (6 * 32, 2 * 24))
        page = (self.folder / "a.html").read_text()
        self.assertGreaterEqual(page.count("<svg"), 2)
        self.assertNotRegex(page, r"(src|href)=\"(?!data:)")
        self.assertIn("### Monte Carlo", (self.folder / "a.md").read_text())
        # That of the view, whose light has a side of 1, that of the other size, and three frames of the walk.
        self.assertEqual(len(list((self.folder / "kept").iterdir())), 2 + 3)

    def test_what_the_fragments_suite_refuses(self):
        self.fails(2, "bench", "fragment", says="fragments")
        self.fails(2, "bench", "fragments", "--part", "curves", says="curve")
        self.fails(2, "bench", "fragments", "--view", "conferense", says="conference")
        self.fails(2, "bench", "fragments", "--ce", "8", says=("--ce", "visibility-cache"))
        self.fails(2, "bench", "fragments", "--truth-samples", "0")
        for part, option in (("interactive", ("--rounds", "2")), ("interactive", ("--cache-dir", "x")), ("table,curve", ("--strip", "a.png"))):
            self.fails(2, "bench", "fragments", "--part", part, *option, says=(option[0], "--part"))
        self.fails(2, "bench", "visibility-cache", "--truth-samples", "4", says=("--truth-samples", "fragments"))
        self.fails(2, "bench", "--cache-dir", "x", says="fragments")
        self.assertEqual(self.files(), [])
        run = self.ok("bench", "fragments", "--view", "conference", "--data", ".", "--json", "-")
        self.assertIn("conference", run.err)
        self.assertEqual(json.loads(run.out)["table"], [])
        run = self.ok("bench", "fragments", "--view", "builtin:textured", "--size", "32x24", "--quick", "--json", "-")
        self.assertIn("directional", run.err)
        self.assertEqual(json.loads(run.out)["table"], [])

    SQUARES = ("bench", "square-lights", "--quick", "--size", "32x24", "--threads", 2, "--bake-dir", "kept")

    def test_square_lights_on_what_stands_still(self):
        run = self.ok(*self.SQUARES, "--view", "builtin:ground,content=hairball?triangles=600", "--part", "errors,bakes,edit,storage,beyond,pictures",
                "--truth-samples", 16, "--json", "a.json", "--markdown", "a.md", "--html", "a.html")
        # Settings of all candidates are known.
        self.assertNotIn("left out", run.err)
        results = self.json("a.json")
        self.assertEqual((results["suite"], results["threads"], results["quick"], results["interrupted"]), ("square-lights", 2, True, False))
        errors = results["errors"][0]
        self.assertEqual((errors["size"], errors["cube"]), ([32, 24], 8))
        squares = [row for row in errors["rows"] if row["basis"] == "squares"]
        self.assertEqual([row["lights"] for row in squares], [10, 30, 60, 100, None])
        self.assertEqual([row["lights"] for row in errors["rows"] if row["basis"] == "haar"], [20, 30, 60, 100])
        for row in errors["rows"] + results["beyond"][0]["rows"] + results["storage"][0]["rows"]:
            self.assertTrue(math.isfinite(row["l2"]), row)
        self.assertLess(squares[3]["l2_tables"], squares[0]["l2_tables"])
        self.assertEqual(squares[4]["l2_tables"], 0)
        bakes = results["bakes"][0]
        self.assertEqual(bakes["parts"], 0)
        self.assertEqual({row["kind"].split(".")[1] for row in bakes["rows"]}, {"lights", "self-visibility"})
        self.assertEqual([row["isotropic"] for row in results["edit"][0]["rows"]], [None, True, True, True, False])
        storage = results["storage"][0]
        self.assertEqual(storage["tables_of"], "vertices")
        self.assertTrue(all(row["bytes"] > 0 for row in storage["rows"]), storage)
        page = (self.folder / "a.html").read_text()
        self.assertGreaterEqual(page.count("<svg"), 1)
        self.assertNotRegex(page, r"(src|href)=\"(?!data:)")
        for figure in ("Figure 6", "Figure 11", "Figure 15", "Figure 16"):
            self.assertIn(figure, page)
        self.assertIn("### Materials edited", (self.folder / "a.md").read_text())
        self.assertGreater(len(list((self.folder / "kept").iterdir())), 3)

    def test_square_lights_on_what_moves(self):
        self.ok(*self.SQUARES, "--view", "builtin:ground,content=hairball?triangles=600,spin=2", "--part", "speed,moving", "--truth-samples", 16, "--json", "a.json",
                "--strip", "a.png")
        results = self.json("a.json")
        speed, moving = results["speed"][0], results["moving"][0]
        self.assertEqual((speed["parts"], speed["occlusion_rays"], moving["occlusion_rays"]), (1, 0, 0))
        self.assertGreater(speed["frames_per_second"], 0)
        self.assertEqual([row["frame"] for row in moving["rows"]], [0, 4, 8])
        self.assertTrue(all(math.isfinite(row["flip"]) for row in moving["rows"]))
        self.assertEqual(png_size((self.folder / "a.png").read_bytes()), (3 * 16, 2 * 12))

    def test_what_the_square_lights_suite_refuses(self):
        self.fails(2, "bench", "square-light", says="square-lights")
        self.fails(2, "bench", "square-lights", "--part", "error", says="errors")
        self.fails(2, "bench", "square-lights", "--view", "armadilo-sky", says="armadillo-sky")
        self.fails(2, "bench", "square-lights", "--ce", "8", says=("--ce", "visibility-cache"))
        self.fails(2, "bench", "fragments", "--bake-dir", "x", says=("--bake-dir", "square-lights"))
        for part, option in (("speed,edit", ("--strip", "a.png")), ("errors", ("--truth-samples", "4"))):
            self.fails(2, "bench", "square-lights", "--part", part, *option, says=(option[0], "--part"))
        self.assertEqual(self.files(), [])
        run = self.ok("bench", "square-lights", "--view", "duck-sky", "--data", ".", "--json", "-", "--bake-dir", "")
        self.assertIn("duck-sky", run.err)
        self.assertEqual(json.loads(run.out)["errors"], [])
        # A light without a table.
        run = self.ok("bench", "square-lights", "--view", "builtin:textured", "--size", "32x24", "--quick", "--json", "-", "--bake-dir", "")
        self.assertIn("left out", run.err)


if __name__ == "__main__":
    main(globals())
