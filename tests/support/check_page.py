#!/usr/bin/env python3
"""Opens a page in headless Chromium and fails if a script fails or the page's own check of itself does not say "ok".

The page comes from --page FILE, or from a program: --maker PROGRAM is run as `PROGRAM KIND FILE`. Needs no network; the browser's profile
lies in a temporary folder. --screenshot FILE keeps a picture of the page.
"""
import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

BROWSERS = ("chromium", "chromium-browser", "google-chrome")
# Where Chromium itself complains about its surroundings (no D-Bus, no GPU), the page is not at fault; scripts report through CONSOLE.
SCRIPT_PROBLEM = re.compile(r"CONSOLE.*|Uncaught .*|Refused to .*")


def browser_command(browser, profile):
    return [browser, "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--hide-scrollbars",
            "--disable-background-networking", "--disable-component-update", "--disable-sync", "--disable-dev-shm-usage",
            "--disable-extensions", "--host-resolver-rules=MAP * ~NOTFOUND", f"--user-data-dir={profile}",
            "--enable-logging=stderr", "--v=0", "--virtual-time-budget=20000", "--window-size=1500,1250"]


def run(command):
    done = subprocess.run(command, capture_output=True, timeout=100, check=False)
    return done.stdout.decode("utf-8", "replace"), done.stderr.decode("utf-8", "replace")


def page_problems(browser, page, fragment, screenshot, folder):
    command = browser_command(browser, folder / "profile")
    url = page.resolve().as_uri() + (f"#{fragment}" if fragment else "")
    dom, log = run(command + ["--dump-dom", url])
    if screenshot:
        run(command + [f"--screenshot={screenshot}", url])
    problems = [match.group(0) for match in map(SCRIPT_PROBLEM.search, log.splitlines()) if match]
    if "</html>" not in dom:
        return problems + ["the browser gave no page; its last words: " + " | ".join(log.splitlines()[-3:])]
    # Only pages with scripts check themselves.
    if "<script" in dom:
        verdict = re.search(r'<html[^>]*data-self-check="([^"]*)"', dom)
        if not verdict:
            problems.append("the page did not finish checking itself")
        elif verdict.group(1) != "ok":
            problems.append("the page says: " + verdict.group(1))
    elif re.search(r"<img(?![^>]*src=\"data:image/)", dom):
        problems.append("a picture is not inside the page")
    return problems


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--page", type=pathlib.Path)
    parser.add_argument("--maker")
    parser.add_argument("--kind", default="")
    parser.add_argument("--fragment", default="")
    parser.add_argument("--screenshot", type=pathlib.Path)
    parser.add_argument("--expect-failure", action="store_true")
    options = parser.parse_args()

    browser = next((path for path in map(shutil.which, BROWSERS) if path), None)
    if not browser:
        if os.environ.get("SIGHTLINE_NO_BROWSER") == "1":
            print("no browser, and SIGHTLINE_NO_BROWSER=1: the page was not opened")
            return 0
        print("no Chromium found: run scripts/install-deps.sh, or set SIGHTLINE_NO_BROWSER=1 to leave this test out", file=sys.stderr)
        return 1
    with tempfile.TemporaryDirectory(prefix="sightline-page-") as name:
        folder = pathlib.Path(name)
        page = options.page
        if options.maker:
            page = folder / "page.html"
            subprocess.run([options.maker, options.kind, str(page)], check=True)
        problems = page_problems(browser, page, options.fragment, options.screenshot, folder)
    for problem in problems:
        print(problem, file=sys.stdout if options.expect_failure else sys.stderr)
    if options.expect_failure:
        print("noticed, as it should be" if problems else "the damage was not noticed")
        return 0 if problems else 1
    print("the page is sound" if not problems else f"{len(problems)} problems")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
