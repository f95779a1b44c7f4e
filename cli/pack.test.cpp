// SPDX-License-Identifier: Apache-2.0
// `graze pack` and `graze repro PACK`: a campaign runs again where only its pack exists.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/run_graze.h"

namespace graze::cli {
namespace {

class PackCommand : public CommandTest {
 protected:
  // Packs the campaign c in the folder `home`, removes that folder, and runs the pack elsewhere.
  Ran elsewhere(const std::string& variables = "") const {
    expect_done("export XDG_CACHE_HOME=$PWD/cache; cd home && graze pack c --out ../c.sqlar > ../packed");
    return shell("rm -rf home cache; mkdir -p there; cd there; rm -rf c-unpacked; export XDG_CACHE_HOME=$PWD/cache; " +
                 variables + " graze repro ../c.sqlar");
  }
  void run(const std::string& command) const {
    expect_done("mkdir -p home; cd home; export XDG_CACHE_HOME=$PWD/../cache; " + command + " > /dev/null");
  }
  static void expect_reproduced(const Ran& ran) {
    EXPECT_EQ(ran.status, 0) << ran.out << ran.err;
    EXPECT_TRUE(has(ran.out, {"\nReproduced: "})) << ran.err;
    EXPECT_TRUE(has(ran.out, {"\nNothing changed: all "}));
  }
};

TEST_F(PackCommand, ASourceWithItsHeadersRunsElsewhere) {
  run("mkdir -p src include/deep; printf '#include \"near.h\"\\n#include <deep/far.h>\\nextern \"C\" bool meet(const "
      "float* a, "
      "const float* b) { return a[0] > b[0] + kNear + kFar; }' > src/mine.cpp; echo 'static const float kNear = "
      "1e-3f;' > "
      "src/near.h; printf '#pragma once\\n#include \"../farther.h\"\\n' > include/deep/far.h; echo 'static const float "
      "kFar = "
      "2e-3f;' > include/farther.h; graze fuzz --subject mine=src/mine.cpp:meet --flags='-I include -O1' --lanes "
      "'mine/f32/cpu*,exact/f32/cpu' --pairs 400 --out c && graze minimize c 2> /dev/null");
  expect_reproduced(elsewhere());
  const std::string manifest = shell.file("there/c-unpacked/pack.json");
  for (const char* name :
       {"subjects/mine/src/mine.cpp:meet", "files/subjects/mine/include/deep/far.h",
        "files/subjects/mine/include/farther.h", "-Isubjects/mine/include", "campaign/failures.json"})
    EXPECT_TRUE(has(manifest, {std::string(name) == "-Isubjects/mine/include" ? "subjects/mine/include" : name}))
        << name;
  EXPECT_FALSE(has(manifest, {shell.folder.string()})) << "a machine's path";
  // The command in the manifest can also be run by hand.
  expect_done("cd there/c-unpacked/files && rm -rf ../again && export XDG_CACHE_HOME=$PWD/cache && " +
              nlohmann::json::parse(manifest)["command"].get<std::string>() +
              " > /dev/null && test -s ../again/summary.json");
  // Unpacking again into the same folder would mix the files.
  expect_error("cd there; graze repro ../c.sqlar", 2, {"c-unpacked"});
}

// Damaged records are not packed, because a pack would pass them on to others.
TEST_F(PackCommand, DamagedRecordsAreNotPacked) {
  run("graze hunt --runs 2000 --lanes '*/f32/cpu' --threads 1 --out c && graze minimize c 2> /dev/null");
  expect_done("cd home && graze pack c --out ../c.sqlar && cp -r c whole");
  for (const auto& [damage, named] : {std::pair("sed -i 's/\"pairs\": 2000/\"pairs\": 9999/' c/hunt.json", "hunt.json"),
                                      {"rm c/hunt.json", "hunt.json"},
                                      {"printf x >> c/hunt/000001.round", "c/hunt"},
                                      {"rm c/hunt/000001.round", "c/hunt"},
                                      {"sed -i 's/\"seconds\": /\"seconds\": 1/' c/timings.json", "timings.json"},
                                      {"sed -i 's/\"pairs\": /\"pairs\": 1/' c/failures.json", "failures.json"}})
    expect_error(std::string("cd home; rm -rf c; cp -r whole c; ") + damage + "; graze pack c --force", 1, {named});
  for (const char* ignored : {"--executor twin", "--toolchains x86-gcc", "--resubject", "--lanes '*'"})
    expect_error(std::string("graze repro c.sqlar ") + ignored, 2, {"leave out", "--executor"});
  expect_out("mkdir there && cd there && graze repro ../c.sqlar", {"\nReproduced: "});
}

TEST_F(PackCommand, LibrariesCommandsMeshesAndScenesRunElsewhere) {
  const std::string mesh =
      "printf 'OFF\\n4 4 0\\n0 0 0\\n1 0 0\\n0 1 0\\n0 0 1\\n3 0 1 2\\n3 0 1 3\\n3 0 2 3\\n3 1 2 3\\n' > 'a "
      "mesh.off'; ";
  run("echo 'int meet(const float* a, const float* b) { return a[1] > b[2]; }' > l.c; cc -shared -fPIC l.c -o liba.so; "
      "graze fuzz "
      "--subject lib=./liba.so:meet --lanes lib/f32/cpu --pairs 200 --out c");
  expect_reproduced(elsewhere());
  run("mkdir -p bin; printf '#!/bin/sh\\nwhile read x; do echo 1; done\\n' > bin/own.sh; chmod +x bin/own.sh; graze "
      "fuzz --subject "
      "'own=cmd:bin/own.sh' --subject \"two=cmd:sh $PWD/bin/own.sh\" --lanes 'own/f32/cpu,two/f32/cpu' --pairs 60 "
      "--out c");
  expect_reproduced(elsewhere());
  EXPECT_TRUE(has(shell.file("packed"), {"two: the pack does not contain sh, "}));
  run(mesh + "graze fuzz --mesh 'a mesh.off' --lanes 'moller_1997/f32/cpu' --strata thesis --pairs 50 --out c");
  expect_reproduced(elsewhere());
  run(mesh +
      "mkdir -p sub; graze scene 'a mesh.off' --out sub/s.toml; graze fuzz --scene sub/s.toml --strata mesh,uniform "
      "--lanes 'moller_1997/f32/cpu' --pairs 100 --out c");
  expect_reproduced(elsewhere());
  run(mesh +
      "graze scene 'a mesh.off' --out s.toml; graze fuzz --scene s.toml --lanes 'moller_1997/f32/cpu' --pairs 200 "
      "--out c");
  expect_reproduced(elsewhere());
}

TEST_F(PackCommand, ThePackHasNoTraceOfWhenItWasMade) {
  run("graze fuzz --lanes moller_1997/f32/cpu --strata near_edge_edge --pairs 300 --out c");
  expect_done("cd home; graze pack c; mv c.sqlar first; touch c/*; graze pack c; cmp c.sqlar first; graze pack c");
}

// If code reads more than its pack contains, differences are named, and the exit status is 1.
TEST_F(PackCommand, WhatDiffersElsewhereIsSaid) {
  run("printf 'while read x; do echo $ANSWER; done' > own.sh; export ANSWER=1; graze fuzz --subject 'own=cmd:sh "
      "own.sh' --lanes "
      "own/f32/cpu --strata uniform --pairs 80 --out c");
  const Ran ran = elsewhere("ANSWER=0");
  EXPECT_EQ(ran.status, 1) << ran.out << ran.err;
  EXPECT_TRUE(has(ran.out, {"\nNot reproduced: ", "\nChanged: "}));
}

TEST_F(PackCommand, WhatCannotBePackedIsRefusedInOneLine) {
  expect_error("graze pack none", 1, {"none", "summary.json"});
  run("echo 'int intersects(const float* a, const float* b) { return a[0] > b[0]; }' > m.c; graze fuzz --subject "
      "mine=./m.c --lanes "
      "mine/f32/cpu --pairs 100 --out c");
  const std::string in = "export XDG_CACHE_HOME=$PWD/cache; cd home; ";
  expect_error(in + "echo > foreign; graze pack c --out foreign", 2, {"foreign", "--force"});
  expect_error(in + "cp c/campaign.sqlite d.sqlar; graze pack c --out d.sqlar", 2, {"d.sqlar"});
  expect_error(in + "graze pack c > /dev/null && graze repro c.sqlar --lanes 'mine/*'", 2, {"--lanes"});
  expect_error(in + "mkdir c-unpacked; graze repro c.sqlar", 2, {"c-unpacked"});
  expect_error(in + "head -c 5000 c.sqlar > cut.sqlar; graze repro cut.sqlar", 1, {"cut.sqlar"});
  expect_error(in + "cp m.c kept; sed -i s/0/1/ m.c; graze pack c; status=$?; mv kept m.c; exit $status", 1,
               {"m.c", "changed"});
  expect_error(in + "rm c/campaign.sqlite; graze pack c", 1, {"c", "campaign.sqlite"});
  run("printf 'OFF\\n4 2 0\\n0 0 0\\n1 0 0\\n0 1 0\\n0 0 1\\n3 0 1 2\\n3 0 1 3\\n' > mesh.off; graze scene mesh.off "
      "--out "
      "s.toml; graze fuzz --scene s.toml --lanes 'moller_1997/f32/cpu' --pairs 20 --out s");
  expect_error(in + "sed -i 's/^1 0 0/2 0 0/' mesh.off; graze pack s", 1, {"mesh.off", "changed"});
}

}  // namespace
}  // namespace graze::cli
