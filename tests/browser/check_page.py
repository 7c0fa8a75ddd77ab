"""Checks the page in headless Chromium against the program `roadgrade`.

    check_page.py PAGE.html ROADGRADE FOLDER [--pictures DIR]

FOLDER has cases, a folder each: the files that are dropped on the page. Where `roadgrade map` makes a
map of them, the page must offer the same files, byte for byte. Where it refuses them, the page must
show the same words, or those of a file `reason` in the folder. A folder `timed` is timed, too.
"""

import argparse
import json
import os
import re
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from chromium import Chromium

LONGEST_S = 300
REASON = "reason"
SCREENS = [(390, 844), (1280, 900)]


# Asks for something elsewhere. Gives the policy that refuses it.
ASK = """() => new Promise((take) => {
    addEventListener('securitypolicyviolation', (event) => take(event.violatedDirective));
    fetch('http://localhost:9/').catch(() => 0).then(() => setTimeout(() => take('nothing'), 500));
})"""
ASK_IN_WORKER = f"""new Promise((take) => {{
    const text = {json.dumps(f"({ASK})().then(postMessage)")};
    new Worker(URL.createObjectURL(new Blob([text]))).onmessage = (event) => take(event.data);
}})"""


def files_of(folder):
    """Returns the content of every file in a folder and its folders, by path."""
    paths = (path for path in folder.rglob("*") if path.is_file())
    return {str(path.relative_to(folder)): path.read_bytes() for path in paths}


def natively(roadgrade, case, out):
    """Runs `map` on a case. Returns the files that it writes, or the reason why not, and its time."""
    if (case / REASON).exists():
        return None, (case / REASON).read_text().strip(), None
    names = sorted(os.listdir(case))
    options = [word for name in names if name.endswith(".toml") for word in ("--vehicle", name)]
    logs = [name for name in names if not name.endswith(".toml")]
    command = [os.path.abspath(roadgrade), "map", "--quiet", "--out", str(out), *options, *logs]
    begun = time.monotonic(), cpu_of_children_s()
    done = subprocess.run(command, cwd=case, capture_output=True, text=True)
    taken = time.monotonic() - begun[0], cpu_of_children_s() - begun[1]
    reason = done.stderr.removeprefix("roadgrade: ").strip()
    return (files_of(out) if done.returncode == 0 else None), reason, taken


def cpu_of_children_s():
    """Returns the time that ended children of this process computed, s."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def dropped(case):
    """Returns the files of a case that are dropped on the page."""
    return sorted(path for path in case.iterdir() if path.name != REASON)


class Page:
    """The page in a browser, with a folder for its downloads."""

    def __init__(self, url, downloads):
        self.downloads = Path(downloads)
        self.browser = Chromium()
        self.browser.call("Browser.setDownloadBehavior", behavior="allow", downloadPath=downloads)
        self.browser.open(url)
        self.await_state("waiting")

    def await_state(self, *states):
        """Waits for a state of the page, and returns it."""
        # The page tells it: asking again and again would take its time.
        state = self.browser.evaluate(
            """new Promise((take) => {
                const look = () => (%s).includes(document.body?.dataset.state) && take(document.body.dataset.state);
                new MutationObserver(look).observe(document, { attributes: true, childList: true, subtree: true });
                look();
                setTimeout(() => take(null), %d);
            })"""
            % (json.dumps(states), 1000 * LONGEST_S)
        )
        if state is None:
            raise RuntimeError(f"the page is not {' or '.join(states)} in {LONGEST_S} s")
        return state

    def work(self, files, is_dropped):
        """Gives files to the page. Returns what it offers, or the reason why not, and its time."""
        self.browser.evaluate("document.body.dataset.state = 'asked'")
        begun = time.monotonic(), self.browser.cpu_s()
        if is_dropped:
            self.browser.drop(files)
        else:
            self.browser.choose("#files", files)
        state = self.await_state("done", "failed")
        taken = time.monotonic() - begun[0], self.browser.cpu_s() - begun[1]
        if state == "failed":
            return None, self.browser.evaluate("document.getElementById('problem').textContent"), taken
        return self.download(), "", taken

    def download(self):
        """Clicks on every file that is offered, and returns their content by path."""
        paths = self.browser.evaluate(
            "[...document.querySelectorAll('#downloads a')].map((link) => link.dataset.path)"
        )
        files = {}
        for number, path in enumerate(paths):
            self.browser.evaluate(f"document.querySelectorAll('#downloads a')[{number}].click()")
            files[path] = self.downloaded(Path(path).name)
        return files

    def downloaded(self, name):
        until = time.monotonic() + LONGEST_S
        path = self.downloads / name
        # While it is not whole, it has another name.
        while not path.exists():
            if time.monotonic() > until:
                raise RuntimeError(f"{name} is not downloaded")
            self.browser.evaluate("0")
            time.sleep(0.02)
        content = path.read_bytes()
        path.unlink()
        return content


def comparable(files, path):
    """Returns a file as it is compared: byte for byte.

    The figures of the page have 16 digits, and the host's sines are those of the system: their last
    digits are left out.
    """
    content = files.get(path)
    if content is None or not path.endswith(".html"):
        return content
    return re.sub(rb"(\.\d{6})\d+", rb"\1", content)


def compare(case, expected, found):
    """Prints how the page differs. Returns true if it does not."""
    (files, reason, _), (own_files, own_reason, _) = expected, found
    if files is None:
        if own_files is None and own_reason.strip() == reason:
            print(f"{case.name}: refused with the same words: {reason}")
            return True
        print(f"{case.name}: the program says {reason!r}, the page {own_reason!r}")
        return False
    if own_files is None:
        print(f"{case.name}: the page refuses it: {own_reason}")
        return False
    own_files.pop("summary.json")
    paths = files.keys() | own_files.keys()
    wrong = [path for path in paths if comparable(files, path) != comparable(own_files, path)]
    for path in sorted(wrong):
        print(f"{case.name}: {path} differs")
    if not wrong:
        cells = sum(text.count(b"\n") - 1 for path, text in files.items() if path.startswith("runs/"))
        print(f"{case.name}: the same {len(files)} files, {cells} cells")
    return not wrong


def tell_times(natively, in_page):
    """Prints how long the program and the page took: the time on the clock, and that of computing."""
    for what, own, page in zip(("time", "computing"), natively, in_page):
        print(f"timed, {what}: {own:.2f} s natively, {page:.2f} s in the page, {page / own:.2f} times")


def is_alone(page, url):
    """Returns true if the page asked for nothing but itself, and cannot ask."""
    foreign = [asked for asked in page.browser.requests if not asked.startswith((url, "data:", "blob:"))]
    refused = [page.browser.evaluate(f"({ASK})()"), page.browser.evaluate(ASK_IN_WORKER)]
    print(f"requests to elsewhere: {len(foreign)}; in page and worker they are refused by {' and '.join(refused)}")
    return not foreign and refused == ["connect-src", "connect-src"]


def picture(page, folder, name):
    """Writes a picture of the page as it is, on each screen."""
    if folder is None:
        return
    for width, height in SCREENS:
        page.browser.resize(width, height)
        time.sleep(0.5)
        page.browser.picture(folder / f"{name}-{width}.png")


def main():
    """Checks all cases."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("page", type=Path)
    parser.add_argument("roadgrade", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--pictures", type=Path)
    args = parser.parse_args()
    url = args.page.resolve().as_uri()
    good = True
    with tempfile.TemporaryDirectory() as scratch:
        downloads = Path(scratch) / "downloads"
        downloads.mkdir()
        page = Page(url, str(downloads))
        try:
            picture(page, args.pictures, "before")
            for number, case in enumerate(sorted(path for path in args.folder.iterdir() if path.is_dir())):
                expected = natively(args.roadgrade, case, Path(scratch) / "out")
                shutil.rmtree(Path(scratch) / "out", ignore_errors=True)
                found = page.work(dropped(case), is_dropped=number % 2 == 0)
                good &= compare(case, expected, found)
                picture(page, args.pictures, case.name)
                if case.name == "timed":
                    tell_times(expected[2], found[2])
            good &= is_alone(page, url)
        finally:
            page.browser.close()
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
