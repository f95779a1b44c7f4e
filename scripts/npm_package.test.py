# SPDX-License-Identifier: Apache-2.0
"""The npm package works for a new user who installs it offline from its tarball into an empty project: its examples
run, and TypeScript accepts its types. Under `node --test`, a wrong function fails with a smallest pair, and a correct
function passes. If there is a Chromium, the three.js example also runs in it."""
import functools
import http.server
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import unittest

ROOT = pathlib.Path(__file__).parent.parent
BUILT = pathlib.Path(sys.argv.pop()).resolve()
README = (ROOT / "wasm/package/README.md").read_text(encoding="utf-8")
MODULES = BUILT / "web/node_modules"

BOXES = """export function overlap(a, b) {
  for (let c = 0; c < 3; ++c) {
    const x = [a[c], a[c + 3], a[c + 6]], y = [b[c], b[c + 3], b[c + 6]];
    if (Math.max(...x) < Math.min(...y) || Math.max(...y) < Math.min(...x)) return false;
  }
  return true;
}
"""
RIGHT = "import { ready } from 'graze-wasm';\nexport const overlap = (await ready()).intersects;\n"
TYPED = """import { load, ready, testOverlap, type Graze } from 'graze-wasm';
const graze: Graze = await ready();
const meets: boolean = graze.intersects(new Float32Array(9), [0, 0, 0, 1, 0, 0, 0, 1, 0]);
const { least, most }: { least: number; most: number } = graze.margin(new Float32Array(18));
const boxes = (a: Float32Array, b: Float32Array) => a[0] < b[0] || meets;
const result = await testOverlap(boxes, { either: ['touching'], max_wrong: 1 });
const smallest: number[] | undefined = result.smallest?.a;
export { load, least, most, smallest };
"""


# Prints a page's result as soon as it is ready.
READ = """import { chromium } from '%s/@playwright/test/index.mjs';
const [executablePath, address] = process.argv.slice(2);
const browser = await chromium.launch({ executablePath, args: ['--no-sandbox'] });
const page = await browser.newPage();
await page.goto(address);
await page.locator('#result', { hasText: 'meet' }).waitFor({ timeout: 120000 });
console.log(await page.textContent('#result'));
await browser.close();
"""


def block(start):
    """The code block of the README that contains this text."""
    return next(code for code in re.findall(r"```\w*\n(.*?)```", README, re.S) if start in code)


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


class Package(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = cls.enterClassContext(tempfile.TemporaryDirectory())
        cls.project = pathlib.Path(folder, "project")
        cls.project.mkdir()
        cls.environment = {"HOME": folder, "PATH": os.environ["PATH"], "npm_config_cache": f"{folder}/npm"}
        packed = subprocess.run(
            [ROOT / "scripts/npm_package", "--wasm", BUILT / "wasm/graze.wasm", "--out", folder],
            capture_output=True,
            text=True,
        )
        if packed.returncode == 77:
            raise unittest.SkipTest(packed.stderr)
        assert packed.returncode == 0, packed.stderr
        cls.run_in("npm", "init", "--yes")
        cls.run_in("npm", "pkg", "set", "type=module")
        cls.run_in("npm", "install", "--offline", "--no-audit", "--no-fund", packed.stdout.strip())

    @classmethod
    def run_in(cls, *command, status=0, **environment):
        ran = subprocess.run(
            command, cwd=cls.project, env={**cls.environment, **environment}, capture_output=True, text=True
        )
        assert ran.returncode == status, f"{command} ends with {ran.returncode}:\n{ran.stdout}{ran.stderr}"
        return ran.stdout + ran.stderr

    def script(self, text, **more):
        (self.project / "script.mjs").write_text(text, encoding="utf-8")
        return self.run_in("node", "script.mjs", **more)

    def node_test(self, function, status, **environment):
        (self.project / "overlap.mjs").write_text(function, encoding="utf-8")
        (self.project / "overlap.test.mjs").write_text(block("node:test"), encoding="utf-8")
        return self.run_in("node", "--test", status=status, **environment)

    def test_the_readmes_first_lines_run(self):
        lines = re.sub(r"^(graze\..*\)); // ", r"console.log(\1); // ", block("await ready()"), flags=re.M)
        self.assertEqual(self.script(lines), "true\n")

    def test_the_example_runs(self):
        said = self.run_in("node", "node_modules/graze-wasm/examples/example.mjs")
        self.assertIn("a quarter above: disjoint, contact none, margin 0.250 to 0.250\n", said)

    def test_a_wrong_function_fails_with_the_readmes_smallest_pair(self):
        said = re.sub(r"^ +", "", self.node_test(BOXES, status=1), flags=re.M)
        self.assertIn("b = [0, 0, 1, 0, -1, 0, 1, 0, 0]; // right: false", said)
        for line in block("36,443").splitlines():
            if line.strip() != "…":
                self.assertIn(line.strip(), said)
        # The counts and the pair are the same as in C++.
        cpp = (ROOT / "docs/testing.md").read_text(encoding="utf-8")
        self.assertIn(re.search(r"overlap is wrong on .*", said)[0], cpp)
        a, b = re.search(r"a = \[(.*)\],\n *b = \[(.*)\];", said).groups()
        self.assertIn(f"const float a[9] = {{{a}}},\n              b[9] = {{{b}}};", cpp)

    def test_a_right_function_passes(self):
        self.assertIn("pass 1", self.node_test(RIGHT, status=0))

    def test_the_environment_changes_how_many_pairs(self):
        said = self.node_test(BOXES, status=1, GRAZE_PAIRS="210", GRAZE_SEED="7")
        self.assertRegex(said, r"is wrong on \d+ of 210 pairs")
        self.assertIn(
            "GRAZE_PAIRS: expected a whole number, found 'many'", self.node_test(BOXES, 1, GRAZE_PAIRS="many")
        )

    def test_exceptions_are_wrong_and_declined_answers_are_not(self):
        said = self.script(
            "import { testOverlap } from 'graze-wasm';\n"
            "const why = async (f, more) => testOverlap(f, { pairs: 2100, ...more })\n"
            "  .then((r) => `passed, ${r.declined} declined`, (e) => `${e.message} ${e.cause}`);\n"
            "const { intersects } = await (await import('graze-wasm')).ready();\n"
            "const some = (a, b) => { if (a[0] > b[0]) throw new Error('planted'); return intersects(a, b); };\n"
            "console.log(await why(some));\n"
            "console.log(await why((a, b) => a[0] > b[0] ? -1 : intersects(a, b)));\n"
            "console.log(await why(() => -1, { name: 'unsure' }));\n"
            "console.log(await why(() => undefined, { name: 'empty' }));\n"
            "console.log(await why((a, b) => false, { strata: 'shared_*', either: ['shared'] }));\n"
            "console.log(await why((a, b) => false, { strata: 'shared_*' }));\n"
            "console.log(await why(() => true, { stratum: 'near_*' }));\n"
            "console.log(await why('boxes'), await why(undefined));\n"
            "console.log(await why((a, b) => false, { strata: ['shared_*'], either: 'shared' }));\n"
            "for (const strata of ['no_such', '!*', 'uniform,!uniform'])\n"
            "  console.log(await why(() => true, { strata }));\n"
        ).splitlines()
        text = "\n".join(said)
        self.assertRegex(said[0], r"is wrong on [\d,]+ of 2,100 pairs .*: [\d,]+ exceptions\.")
        self.assertIn("it throws, but the triangles", text)
        self.assertIn("Error: planted", text)
        self.assertRegex(text, r"passed, [1-9]\d+ declined")
        self.assertIn("unsure declines every pair", text)
        self.assertIn("empty returns undefined; expected true, false", text)
        self.assertEqual(text.count("passed, 0 declined"), 2)
        self.assertIn("there is no option 'stratum'", text)
        self.assertIn("expected a function of two triangles, found string", text)
        self.assertIn("expected a function of two triangles, found undefined", text)
        self.assertIn("It first threw: Error: planted", text)
        self.assertIn("is wrong on 2,100 of 2,100 pairs (100 %)", text)
        self.assertIn("none matches 'no_such'", text)
        self.assertEqual(text.count("leaves none"), 2)

    def test_coordinates_that_float32_would_round_are_refused(self):
        said = self.script(
            "import { ready } from 'graze-wasm';\nconst { intersects } = await ready();\n"
            "const t = [0, 0, 0, 1, 0, 0, 0, 1, 0];\n"
            "for (const x of [0.1, NaN, 1e39])\n"
            "  try { intersects(t, Object.assign([...t], [x])); } catch (e) { console.log(e.message); }\n"
            "console.log(intersects(t, Object.assign([...t], [Math.fround(0.1)])));\n"
        )
        self.assertEqual(said.count("expected finite float32 numbers"), 3)
        self.assertTrue(said.endswith("true\n"), said)

    def test_typescript_takes_the_types(self):
        shutil.copytree(MODULES / "typescript", self.project / "typescript", dirs_exist_ok=True)
        compile_it = ("node", "typescript/bin/tsc", "--noEmit", "--strict", "--target", "es2022", "typed.mts")
        for module in ("nodenext", "esnext --moduleResolution bundler"):
            (self.project / "typed.mts").write_text(TYPED, encoding="utf-8")
            self.run_in(*compile_it, "--module", *module.split())
            wrong = TYPED.replace("'touching'", "'touch'").replace("least: number;", "least: string;")
            (self.project / "typed.mts").write_text(wrong, encoding="utf-8")
            said = self.run_in(*compile_it, "--module", *module.split(), status=2)
            self.assertEqual(re.findall(r"typed.mts\((\d+),", said), ["4", "6"], said)

    def test_geometries_of_three_in_node(self):
        shutil.copytree(MODULES / "three", self.project / "node_modules/three", dirs_exist_ok=True)
        said = self.script(
            "import { BoxGeometry } from 'three';\nimport { meeting } from 'graze-wasm/examples/three.mjs';\n"
            "const box = new BoxGeometry(2, 2, 2), moved = (x) => new BoxGeometry(2, 2, 2).translate(x, 0, 0);\n"
            "for (const x of [2, 2.5]) console.log((await meeting(box, moved(x))).length);\n"
            "console.log((await meeting(box.toNonIndexed(), moved(2))).length);\n"
        ).split()
        self.assertEqual(said[1], "0")
        self.assertEqual(said[0], said[2])
        self.assertGreater(int(said[0]), 4)

    def test_geometries_of_three_in_a_browser(self):
        chromium = shutil.which("chromium") or shutil.which("google-chrome")
        if not chromium:
            self.skipTest("no Chromium: Debian's package chromium")
        shutil.copytree(MODULES / "three", self.project / "node_modules/three", dirs_exist_ok=True)
        handler = functools.partial(Quiet, directory=self.project)
        with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
            threading.Thread(target=server.serve_forever, daemon=True).start()
            page = f"http://127.0.0.1:{server.server_port}/node_modules/graze-wasm/examples/three.html"
            (self.project / "read.mjs").write_text(READ % MODULES, encoding="utf-8")
            said = self.run_in("node", "read.mjs", chromium, page)
            server.shutdown()
        self.assertRegex(said, r"touching boxes: [1-9]\d* pairs of triangles meet; apart: 0 pairs")


if __name__ == "__main__":
    unittest.main()
