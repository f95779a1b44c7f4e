#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the direction of every #include: a file includes from its own folder and from those before it in the order of
add_subdirectory in the root CMakeLists.txt, tests and device code too. The files that a
folder's CMakeLists.txt lists are of the same folders. The folders inside have no cycle, tests, benchmarks and fuzz
targets aside. Some libraries are seen by one folder only, and no algorithm's header includes
another algorithm's.
  check_includes.py ROOT
"""
import fnmatch
import graphlib
import pathlib
import re
import sys

SOURCES = {".h", ".cpp", ".cu", ".cuh", ".inl"}
LEAF = re.compile(r"\.(test|bench|fuzz)\.|_test\.|_testing\.")  # nothing but a program includes these
GENERATED = {
    "build_info.h",
    "embedded.inc",
    "page_template.inc",
    "viewer_template.inc",
    "canaries.inc",
}  # by the build, on an include path of their own

LIBRARIES = [  # what an include names, which library that is, the folder that may see it
    (r"CGAL/|boost/multiprecision/(gmp|mpfr)|gmp(xx)?\.h|mpfr\.h", "CGAL, GMP and MPFR", "oracle"),
    (r"(cuda|nvrtc|curand|cub|thrust|cooperative_groups)(_\w+)?(\.h|/)", "CUDA", "cuda"),
    (r"mpi(cxx)?\.h", "MPI", "fuzz/ranks/mpi.cpp"),
]
EXCEPTIONS = {  # files, the library that they see, and why
    "core/*.test.cpp": ("CGAL, GMP and MPFR", "runs the algorithms on MPFR numbers: they must compile for any scalar"),
    "strata/mesh*.cpp": ("CGAL, GMP and MPFR", "CGAL's mesh readers and box intersection, which decide nothing"),
    "subjects/third_party/cgal.cpp": (
        "CGAL, GMP and MPFR",
        "the library that is tested; scripts/league alone builds it",
    ),
    "fuzz/ranks/mpi.cpp": ("MPI", "the one file that does"),
    "fuzz/lanes.bench.cpp": ("CGAL, GMP and MPFR", "times CGAL's own predicates beside the lanes"),
}


def includes(file):
    for number, line in enumerate(file.read_text(encoding="utf-8").splitlines(), 1):
        found = re.match(r'\s*#\s*include\s*(["<])([^">]+)[">]', line)
        if found:
            yield number, found.group(1) == '"', found.group(2)


def algorithms(root):
    """The headers of published algorithms: those that say so by their kInfo."""
    return {
        f"core/algorithms/{file.name}"
        for file in (root / "core/algorithms").glob("*.h")
        if "AlgorithmInfo kInfo" in file.read_text(encoding="utf-8")
    }


def folder_of(name):
    """The folder two levels deep at most: "cuda/lanes" of "cuda/lanes/device.cu", "cuda" of "cuda/no_device.cpp"."""
    return "/".join(name.split("/")[:-1][:2])


def cycle(arrows):
    """The arrows of one cycle of folders, each as the include that draws it; none where there is no cycle."""
    graph = {}
    for source, target in arrows:
        graph.setdefault(source, set()).add(target)
    try:
        list(graphlib.TopologicalSorter(graph).static_order())
        return []
    except graphlib.CycleError as error:
        way = error.args[1][::-1]  # each folder includes from the next one
        return [arrows[step] for step in zip(way, way[1:])]


def check(root, exceptions):
    """Returns: how many files were read; for each violation file:line, what was expected, what was found."""
    order = re.findall(r"^add_subdirectory\((\w+)\)", (root / "CMakeLists.txt").read_text(encoding="utf-8"), re.M)
    said, used, count, of_algorithms, arrows = [], set(), 0, algorithms(root), {}
    for place, folder in enumerate(order):
        allowed = order[: place + 1]
        for file in sorted((root / folder).rglob("CMakeLists.txt")):
            for other in re.findall(r"\.\./(\w+)/", file.read_text(encoding="utf-8")):
                if other not in allowed:
                    name = file.relative_to(root).as_posix()
                    said.append(f"{name}: expected files of {', '.join(allowed)}, found one of {other}")
        for file in sorted(path for path in (root / folder).rglob("*") if path.suffix in SOURCES):
            count += 1
            name = file.relative_to(root).as_posix()
            for line, quoted, included in includes(file):
                if quoted or (root / included).exists():  # ours
                    right = included in GENERATED or ("/" in included and included.split("/")[0] in allowed)
                    if not right:
                        said.append(f'{name}:{line}: expected a path below {", ".join(allowed)}, found "{included}"')
                    elif name in of_algorithms and included in of_algorithms:
                        said.append(f'{name}:{line}: expected no other algorithm, found "{included}"')
                    if right and included not in GENERATED and not LEAF.search(name):
                        arrow = (folder_of(name), folder_of(included))
                        if arrow[0] != arrow[1]:
                            arrows.setdefault(arrow, f'{name}:{line} includes "{included}"')
                    continue
                for pattern, library, home in LIBRARIES:
                    if folder == home or not re.match(pattern, included):
                        continue
                    excepted = [
                        glob for glob, row in exceptions.items() if row[0] == library and fnmatch.fnmatch(name, glob)
                    ]
                    used.update(excepted)
                    if not excepted:
                        said.append(f"{name}:{line}: expected {library} below {home} only, found <{included}>")
    if found := cycle(arrows):
        said.append("expected folders without a cycle, found " + ", ".join(found))
    for glob in exceptions.keys() - used:
        said.append(
            f"{glob}: expected an include of {exceptions[glob][0]}, which is listed as an exception, found none"
        )
    return count, said


def main(arguments):
    if len(arguments) != 1 or not (pathlib.Path(arguments[0]) / "CMakeLists.txt").is_file():
        print(f"graze: expected the root of the sources, found {arguments}", file=sys.stderr)
        return 2
    count, said = check(pathlib.Path(arguments[0]), EXCEPTIONS)
    print("\n".join(said + [f"{count} files, {len(said)} violations"]))
    return 0 if count and not said else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
