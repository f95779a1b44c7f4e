# SPDX-License-Identifier: Apache-2.0
"""Builds and tests mutants with the commands of a finished build (from ninja)."""
import hashlib
import json
import math
import os
import pathlib
import re
import shlex
import shutil
import signal
import subprocess
import tempfile
import threading

from mutating import tokens

NOT_SWITCHED = 98  # exit status, as in switches.h
# With these checks, a subscript out of range ends the test. Otherwise the test might read an arbitrary value.
CHECKED = ["-w", "-D_GLIBCXX_ASSERTIONS", "-fsanitize=bounds-strict,object-size", "-fsanitize-undefined-trap-on-error"]
MEMORY = 8 << 30  # bytes of address space for each compiler and test


class Refused(Exception):
    """The tests cannot judge a mutant, because they fail even without one."""


class NotCompiled(Exception):
    pass


class Commands:
    """The finished build's compile and link commands, made faster: not optimised, precompiled system headers, lld."""

    def __init__(self, root, build, programs, out):
        self.root, self.build, self.out = root, build, out
        self.compile, self.link = {}, {}
        self.linker = ["-fuse-ld=lld"] if shutil.which("ld.lld") else []
        said = subprocess.run(
            ["ninja", "-C", build, "-t", "commands"], check=True, capture_output=True, text=True
        ).stdout
        for line in said.splitlines():
            source = re.search(r" -c (\S+)$", line)
            if source:
                self.compile[source.group(1)] = line
            for part in line.split(" && "):
                program = re.search(r" -o bin/(\S+) ", part)
                if program and program.group(1) in programs:
                    self.link[program.group(1)] = part

    def flags(self, source, level):
        words = shlex.split(self.compile[str(self.root / source)])
        cache = [k for k, word in enumerate(words) if pathlib.Path(word).name == "ccache"]
        words = words[cache[0] + 1 if cache else 0 :]
        for flag in ["-MF", "-MT", "-o", "-c", "-include"]:  # -include: a precompiled header made with other flags
            if flag in words:
                del words[words.index(flag) : words.index(flag) + 2]
        return [
            level if word in ("-O1", "-O2", "-O3") else word
            for word in words
            if word != "-MD" and not word.startswith("-W")
        ] + CHECKED

    def compiled(self, source, with_source, folder, out, level):
        words = self.flags(source, level)
        included = [*self.precompiled(source, words), "-include", str(pathlib.Path(__file__).with_name("switches.h"))]
        return [words[0], f"-I{folder}", *words[1:], *included, "-o", str(out), "-c", str(with_source)]

    def precompiled(self, source, words):
        """A precompiled header of everything that the source and our headers include in angle brackets, compiled once
        for all mutants. Omits Highway's headers, which are included once for each instruction set."""
        said = subprocess.run(
            [*words, "-E", "-dI", str(self.root / source)],
            cwd=self.build,
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        names, ours = set(), True
        for line in said.splitlines():
            if place := re.match(r'# \d+ "[^"]*"((?: \d)*)$', line):
                ours = " 3" not in place.group(1)  # 3: a system header
            elif ours and (name := re.match(r"#\s*include\s*(<(?!hwy/)[^>]+>)", line)):
                names.add(f"#include {name.group(1)}\n")
        text = "".join(sorted(names))
        header = self.out / "precompiled" / hashlib.sha256((" ".join(words) + text).encode()).hexdigest()[:16] / "all.h"
        if not header.exists():
            header.parent.mkdir(parents=True)
            header.write_text(text, encoding="utf-8")
            subprocess.run([*words, "-x", "c++-header", str(header), "-o", f"{header}.gch"], cwd=self.build, check=True)
        return ["-include", str(header)]

    def linked(self, program, objects, out):
        """The command that links the program with these objects instead of its tests' objects."""
        words = shlex.split(self.link[program])
        words = [word for word in words if not word.endswith(".test.cpp.o") and "/Unity/" not in word]
        at = words.index("-o")
        words[at + 1] = str(out)
        return [*words[:at], *self.linker, *objects, *words[at:]]

    def object_of(self, source):
        words = shlex.split(self.compile[str(self.root / source)])
        return words[words.index("-o") + 1]


def result_of(mutant, state, said):
    by = re.search(r"\[  FAILED  \] ([\w./]+)", said) if state == "killed" else None
    return {**mutant, "state": state, "by": by.group(1) if by else ""}


class Runner:
    def __init__(self, root, build, out, groups, patience=10):
        self.root, self.build, self.out, self.groups, self.patience = root, build, out, groups, patience
        programs = {group["program"] for group in groups.values()} | {
            group["writes"]["program"] for group in groups.values() if "writes" in group
        }
        self.commands = Commands(root, build, programs, out)
        self.kept = out / "baselines.json"
        self.seconds = json.loads(self.kept.read_text(encoding="utf-8")) if self.kept.exists() else {}

    def sources_seeing(self, group, file):
        """The sources to recompile: the file itself or, for a header, the sources that the group names (by default its
        tests)."""
        if file.endswith(".cpp"):
            return [file]
        rows = [row for row in group.get("header", []) if row["file"] == file]
        return next(iter(rows), group).get("seen_by", group["tests"])

    def stages(self, group, seeing):
        """The tests in the order in which they run. First, together, come all tests that need no compilation, if they
        can see the mutant at all. Then the recompiled tests run one by one, because the first one kills most
        mutants."""
        anew = [
            source
            for source in dict.fromkeys([*group["tests"], *seeing])
            if source in seeing and source.endswith(".test.cpp")
        ]
        others = [source for source in group["tests"] if source not in seeing]
        return ([others] if others and set(seeing) != set(anew) else []) + [[source] for source in anew]

    def run(self, command, seconds=600, env=None):
        """Returns: the exit status, the output, and the CPU seconds used. The status is None if the command used
        `seconds` of CPU time, or took ten times as long."""
        limited = ["prlimit", f"--cpu={math.ceil(seconds)}", f"--as={MEMORY}", *command]
        with tempfile.TemporaryFile() as said:
            process = subprocess.Popen(
                limited,
                cwd=self.build,
                stdin=subprocess.DEVNULL,
                stdout=said,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                env={**os.environ, **(env or {})},
            )
            timer = threading.Timer(10 * seconds, os.killpg, (process.pid, signal.SIGKILL))
            timer.start()
            _, status, used = os.wait4(process.pid, 0)
            timer.cancel()
            process.returncode = os.waitstatus_to_exitcode(status)
            said.seek(0)
            ended = process.returncode not in (-signal.SIGXCPU, -signal.SIGKILL)
            return (
                process.returncode if ended else None,
                said.read().decode(errors="replace"),
                used.ru_utime + used.ru_stime,
            )

    def compile(self, group, sources, folder, file=None):
        """Returns: the sources' objects, with `file` mutated.   Throws: NotCompiled."""
        objects = [folder / (source.replace("/", "_") + ".o") for source in sources]
        for source, out in zip(sources, objects):
            path = (folder if source == file else self.root) / source
            status, said, _ = self.run(self.commands.compiled(source, path, folder, out, group.get("level", "-O0")))
            if status != 0:
                raise NotCompiled(said)
        return [str(out) for out in objects]

    def link(self, program, objects, out):
        status, said, _ = self.run(self.commands.linked(program, objects, out))
        if status != 0:
            raise NotCompiled(said)
        return str(out)

    def ask(self, group, program, limit, env=None):
        """Returns: the state, the output, and the CPU seconds that the tests took."""
        filter = f"--gtest_filter={group.get('filter', '*')}"
        status, said, used = self.run([program, "--gtest_brief=1", "--gtest_fail_fast", filter], limit, env)
        states = {None: "timed out", 0: "survived", NOT_SWITCHED: "not switched"}
        return states.get(status, "killed"), said, used

    def time(self, group, program, where, env=None):
        """Returns: the CPU seconds of the tests without a mutant.   Throws: Refused, if they do not pass."""
        state, said, used = self.ask(group, program, 900, env)
        if state != "survived" or " 0 tests" in said:
            raise Refused(
                f"expected the tests of group {group['name']} to pass without a mutant{where}, found: {state}\n{said[-3000:]}"
            )
        return used

    def limit(self, group, stage, anew):
        """Five times the CPU seconds of a stage without a mutant, plus some margin. Without a mutant, the tests must
        pass."""
        key = " ".join([group["name"], *stage, *anew])
        if key not in self.seconds:
            folder = self.out / "baseline"
            folder.mkdir(exist_ok=True)
            objects = self.built(stage, anew) + self.compile(group, anew, folder)
            self.seconds[key] = self.time(group, self.link(group["program"], objects, folder / "tests"), "")
            self.kept.write_text(json.dumps(self.seconds, indent=1), encoding="utf-8")
            shutil.rmtree(folder)
            print(f"{key}: pass without a mutant, in {self.seconds[key]:.1f} s", flush=True)
        return self.patience + 5 * self.seconds[key]

    def built(self, stage, anew):
        return [self.commands.object_of(source) for source in stage if source not in anew]

    def build_and_test(self, group, file, text, folder, limit=None):
        """Returns: the state, and the output of the stage that failed.   Throws: NotCompiled."""
        shutil.rmtree(folder, ignore_errors=True)
        (folder / file).parent.mkdir(parents=True)
        (folder / file).write_text(text, encoding="utf-8")
        seeing = self.sources_seeing(group, file)
        stages = self.stages(group, seeing)
        mutated = self.compile(group, [source for source in seeing if [source] not in stages], folder, file)
        for stage in stages:
            anew = [source for source in stage if source in seeing]
            objects = mutated + self.built(stage, anew) + self.compile(group, anew, folder)
            program = self.link(group["program"], objects, folder / "tests")
            state, said, _ = self.ask(group, program, limit or self.limit(group, stage, anew))
            if state != "survived":
                return state, said
        return self.test_what_it_writes(group, mutated, folder) if "writes" in group else ("survived", "")

    def test_what_it_writes(self, group, mutated, folder, env=None):
        """For a generator: runs its program, which writes sources. If one differs from the build's, runs that source's
        test."""
        writer = self.link(group["writes"]["program"], mutated, folder / "writer")
        for source, flag, written, test in group["writes"]["runs"]:
            (folder / written).parent.mkdir(parents=True, exist_ok=True)
            status, said, _ = self.run(
                [writer, str(self.root / source), flag, str(folder / written)], self.patience, env
            )
            if status != 0:
                return "timed out" if status is None else "killed", said
            if (folder / written).read_bytes() != (self.build / "generated" / written).read_bytes():
                try:
                    program = self.link(
                        group["program"], mutated + self.compile(group, [test], folder), folder / "written"
                    )
                except NotCompiled as what_it_wrote:
                    return "killed", str(what_it_wrote)
                state, said, _ = self.ask(group, program, 60, env)
                if state != "survived":
                    return state, said
        return "survived", ""

    def compile_switched(self, group, file, source, text, numbered, folder):
        """Removes from `numbered` the mutants that the compiler rejects. If its messages name only lines, removes all
        mutants near these lines.   Throws: NotCompiled."""
        while True:
            (folder / file).write_text(tokens.switched(text, numbered), encoding="utf-8")
            try:
                return self.compile(group, [source], folder, file)[0]
            except NotCompiled as error:
                if not numbered:
                    raise
                named = {int(number) for number in re.findall(r"\bint id = (\d+)", str(error))}  # see switches.h
                lines = re.findall(re.escape(file) + r":(\d+):\d+: error", str(error)) or re.findall(
                    re.escape(file) + r":(\d+):", str(error)
                )
                refused = [number for number in numbered if number in named] or [
                    number
                    for number, mutant in numbered.items()
                    if any(abs(mutant["line"] - int(line)) <= 1 for line in lines)
                ]
                for number in refused or list(numbered):
                    del numbered[number]

    def test_together(self, mutants, folder, done):
        """Tests the mutants of one file in one build, each switched on in turn. Calls done with each result.   Returns:
        the mutants that need a separate build.   Throws: NotCompiled; Refused."""
        group, file = self.groups[mutants[0]["group"]], mutants[0]["file"]
        text = (self.root / file).read_text(encoding="utf-8")
        numbered = {number: mutant for number, mutant in enumerate(mutants) if tokens.switch_of(mutant, number, text)}
        shutil.rmtree(folder, ignore_errors=True)
        (folder / file).parent.mkdir(parents=True)
        seeing = self.sources_seeing(group, file)
        stages = self.stages(group, seeing)
        compiled = {
            source: self.compile_switched(group, file, source, text, numbered, folder)
            for source in dict.fromkeys(seeing)
        }
        mutated = [compiled[source] for source in seeing if [source] not in stages]
        asked = []
        for place, stage in enumerate(stages):
            objects = mutated + [
                compiled[source] if source in compiled else self.commands.object_of(source) for source in stage
            ]
            program = self.link(group["program"], objects, folder / f"tests-{place}")
            list_of_asked = folder / f"asked-{place}"
            used = self.time(group, program, f" of {file}", {"GRAZE_MUTANTS_ASKED": str(list_of_asked)})
            asked.append((program, set(list_of_asked.read_text().split()) if list_of_asked.exists() else set(), used))
        for number, mutant in list(numbered.items()):
            env, state = {"GRAZE_MUTANT": str(number)}, "not switched"
            for program, numbers, used in asked:
                if str(number) in numbers:
                    state, said, _ = self.ask(group, program, self.patience + 5 * used, env)
                    if state != "survived":
                        break
            if state == "survived" and "writes" in group:
                state, said = self.test_what_it_writes(group, mutated, folder, env)
            if state == "not switched":
                del numbered[number]
            else:
                done(result_of(mutant, state, said))
        shutil.rmtree(folder)
        return [mutant for mutant in mutants if mutant not in numbered.values()]

    def test(self, mutant, folder):
        """Tests a mutant with a separate build."""
        text = (self.root / mutant["file"]).read_text(encoding="utf-8")
        text = text[: mutant["at"]] + mutant["new"] + text[mutant["at"] + len(mutant["old"]) :]
        try:
            state, said = self.build_and_test(self.groups[mutant["group"]], mutant["file"], text, folder)
        except NotCompiled:
            state, said = "not compiled", ""
        shutil.rmtree(folder, ignore_errors=True)
        return result_of(mutant, state, said)
