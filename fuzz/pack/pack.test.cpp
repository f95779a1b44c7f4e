// SPDX-License-Identifier: Apache-2.0
// Damaged and hostile archives are refused with a one-line error, and nothing is written outside a new folder.
#include "fuzz/pack/pack.h"

#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <random>
#include <set>

#include "core/error.h"
#include "core/message_testing.h"
#include "corpus/pair_format.h"
#include "fuzz/files.h"
#include "fuzz/sealed.h"

namespace graze::fuzz {
namespace {

namespace fs = std::filesystem;

class PackTest : public testing::Test {
 protected:
  PackTest() {
    fs::remove_all(root_);
    fs::create_directories(root_);
  }
  ~PackTest() override { fs::remove_all(root_); }

  // The error of read_archive for these bytes; empty if it reads them.
  std::string refusal(const std::string& bytes) const {
    const fs::path file = root_ / "a.sqlar";
    write_whole(file, bytes);
    const std::string error = error_of<corpus::FormatError>([&] { read_archive(file); });
    EXPECT_TRUE(error.empty() || names(error, {file.string()})) << error;
    return error;
  }

  // The archive's bytes after these SQL statements are run on it.
  std::string edited(const std::string& bytes, const std::string& sql) const {
    const fs::path file = root_ / "edited.sqlar";
    write_whole(file, bytes);
    SQLite::Database(file.string(), SQLite::OPEN_READWRITE).exec(sql);
    return read_whole(file);
  }

  fs::path root_ = fs::temp_directory_path() / fmt::format("graze-pack-{}", getpid());
  const std::vector<PackedFile> files_ = {{"campaign/summary.json", false, "{}"},
                                          {"files/empty", false, ""},
                                          {"files/run.sh", true, std::string(9000, 'x')}};
};

TEST_F(PackTest, FilesComeBackAsTheyWere) {
  const std::string bytes = archive_of(files_);
  EXPECT_EQ(bytes, archive_of({files_[2], files_[0], files_[1]}));
  write_whole(root_ / "a.sqlar", bytes);
  EXPECT_TRUE(is_archive(root_ / "a.sqlar"));
  const std::vector<PackedFile> read = read_archive(root_ / "a.sqlar");
  ASSERT_EQ(read.size(), files_.size());
  unpack(read, root_ / "new");
  for (std::size_t i = 0; i < read.size(); ++i) {
    EXPECT_EQ(read[i].name, files_[i].name);
    EXPECT_EQ(read_whole(root_ / "new" / files_[i].name), files_[i].bytes);
    const fs::perms permissions = fs::status(root_ / "new" / files_[i].name).permissions();
    EXPECT_EQ((permissions & fs::perms::owner_exec) != fs::perms::none, files_[i].is_program);
  }
  EXPECT_THROW(unpack(read, root_ / "new"), UsageError);
  fs::create_directory_symlink(root_ / "new", root_ / "link");
  EXPECT_THROW(unpack(read, root_ / "link"), UsageError);
  fs::create_symlink(root_ / "nowhere", root_ / "dangling");
  EXPECT_THROW(unpack(read, root_ / "dangling"), UsageError);
  EXPECT_FALSE(fs::exists(root_ / "nowhere"));
}

TEST_F(PackTest, NamesThatLeadElsewhereAreRefused) {
  const std::string bytes = archive_of(files_);
  for (const std::string& name :
       {std::string("../evil"), std::string("/etc/evil"), std::string("files/../../evil"), std::string("files/./x"),
        std::string("files//x"), std::string("files/"), std::string(""), std::string("."), std::string("files\\..\\x"),
        std::string("files/a\nb"), std::string("files/\x1b[2J"), "files/" + std::string(256, 'x'),
        std::string(1001, 'x')}) {
    EXPECT_FALSE(may_be_packed(name)) << name;
    write_whole(root_ / "n.sqlar", bytes);
    SQLite::Database again((root_ / "n.sqlar").string(), SQLite::OPEN_READWRITE);
    SQLite::Statement update(again, "UPDATE sqlar SET name = ? WHERE name = 'files/empty'");
    update.bind(1, name);
    update.exec();
    EXPECT_NE(refusal(read_whole(root_ / "n.sqlar")), "") << name;
    EXPECT_THROW(archive_of({{name, false, ""}}), std::runtime_error) << name;
  }
  EXPECT_TRUE(may_be_packed("files/..x/a b.off"));
}

TEST_F(PackTest, WhatIsNoPlainFileIsRefused) {
  const std::string bytes = archive_of(files_);
  const char* const edits[] = {
      "UPDATE sqlar SET mode = 41471, data = '/etc/passwd', sz = 11 WHERE name = 'files/empty'",  // a link
      "UPDATE sqlar SET mode = 41471, sz = -1 WHERE name = 'files/empty'",
      "UPDATE sqlar SET mode = 16877 WHERE name = 'files/empty'",   // a folder
      "UPDATE sqlar SET mode = 35309 WHERE name = 'files/run.sh'",  // a program that runs as its owner
      "UPDATE sqlar SET mode = 'x' WHERE name = 'files/empty'",
      "UPDATE sqlar SET sz = 1000000000000 WHERE name = 'files/run.sh'",  // as if it were compressed
      "UPDATE sqlar SET data = 7 WHERE name = 'files/empty'",
      "UPDATE sqlar SET name = NULL WHERE name = 'files/empty'",
      "UPDATE sqlar SET name = x'66696c6573' WHERE name = 'files/empty'",
      "INSERT INTO sqlar VALUES('files/run.sh/inside', 33188, 0, 0, x'')",  // a file that is also a folder
      "CREATE TABLE more(x)",
      "CREATE TRIGGER t AFTER INSERT ON sqlar BEGIN DELETE FROM sqlar; END",
      "CREATE VIEW v AS SELECT * FROM sqlar",
      "DROP TABLE sqlar",
      "DROP TABLE sqlar; CREATE VIEW sqlar AS SELECT 'files/x' AS name, 33188 AS mode, 0 AS mtime, 0 AS sz, x'' AS "
      "data",
      "PRAGMA application_id = 0"};
  for (const char* sql : edits) EXPECT_NE(refusal(edited(bytes, sql)), "") << sql;
  EXPECT_EQ(refusal(bytes), "");
  EXPECT_NE(refusal(""), "");
  EXPECT_NE(refusal("graze"), "");
}

// If several rows shared pages, the files could be larger than the archive.
TEST_F(PackTest, DamageIsRefusedOrHarmless) {
  std::vector<PackedFile> files = files_;
  for (int i = 0; i < 200; ++i) files.push_back({fmt::format("files/{:03}", i), false, std::string(100, 'y')});
  const std::string bytes = archive_of(files);
  std::mt19937_64 random(7);
  int refused = 0;
  for (int damage = 0; damage < 1500; ++damage) {
    std::string other = bytes;
    const std::size_t at = random() % other.size();
    if (damage % 3 == 0) {
      other.resize(at);
    } else if (damage % 3 == 1) {
      other[at] = static_cast<char>(random());
    } else {
      other.replace(at, 64, bytes.substr(random() % bytes.size(), 64));
    }
    refused += !refusal(other).empty();
    if (refusal(other).empty()) {
      std::size_t size = 0;
      for (const PackedFile& file : read_archive(root_ / "a.sqlar")) {
        EXPECT_TRUE(may_be_packed(file.name));
        size += file.bytes.size();
      }
      EXPECT_LE(size, other.size());
    }
  }
  EXPECT_GT(refused, 300);
}

// pack.json must list every file with its hash, and may name only files in the pack.
TEST_F(PackTest, TheListOfFilesIsChecked) {
  const auto packed = [&](const std::function<void(Json&, std::vector<PackedFile>&)>& edit, bool seal = true) {
    std::vector<PackedFile> files = {{"campaign/summary.json", false, "{}"}, {"files/subjects/m/m.c", false, "int x;"}};
    Json manifest = {
        {"graze_pack", 1},
        {"build", Json::object()},
        {"inputs", {{"subjects", {{{"name", "m"}, {"what", "subjects/m/m.c:x"}, {"flags", Json::array()}}}}}},
        {"command", "graze fuzz"},
        {"not_packed", Json::array()},
        {"files",
         {{{"name", "campaign/summary.json"}, {"bytes", 2}, {"hash", "08f44407b6c5f463"}},
          {{"name", "files/subjects/m/m.c"}, {"bytes", 6}, {"hash", ""}}}}};
    for (std::size_t f = 0; f < 2; ++f) {
      std::uint64_t hash = 0xcbf29ce484222325;
      for (const char c : files[f].bytes) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
      manifest["files"][f]["hash"] = fmt::format("{:016x}", hash);
    }
    edit(manifest, files);
    files.push_back({"pack.json", false, seal ? sealed(manifest).dump(1) + "\n" : manifest.dump(1)});
    write_whole(root_ / "p.sqlar", archive_of(files));
    const std::string error = error_of<corpus::FormatError>([&] { read_pack(root_ / "p.sqlar"); });
    EXPECT_TRUE(error.empty() || names(error, {"p.sqlar"})) << error;
    return error;
  };
  EXPECT_EQ(packed([](Json&, auto&) {}), "");
  using List = std::vector<PackedFile>;
  const std::function<void(Json&, List&)> edits[] = {
      [](Json&, List& files) { files[0].bytes = "{ }"; },
      [](Json&, List& files) { files.pop_back(); },
      [](Json&, List& files) {
        files.push_back({"files/more", false, ""});
      },
      [](Json&, List& files) {
        files.push_back({"elsewhere", false, ""});
      },
      [](Json& manifest, List&) { manifest["graze_pack"] = 2; },
      [](Json& manifest, List&) { manifest["files"][1].erase("hash"); },
      [](Json& manifest, List&) { manifest["files"][1]["bytes"] = -5; },
      [](Json& manifest, List&) { manifest["files"][1]["bytes"] = "x"; },
      [](Json& manifest, List&) { manifest["files"].push_back(manifest["files"][1]); },
      [](Json& manifest, List&) { manifest["inputs"]["subjects"][0]["what"] = "/etc/m.c"; },
      [](Json& manifest, List&) { manifest["inputs"]["subjects"][0]["what"] = "../../m.c:x"; },
      [](Json& manifest, List&) { manifest["inputs"]["mesh"] = {"../mesh.off"}; },
      [](Json& manifest, List&) { manifest["inputs"]["scene"] = "/s.toml"; },
      [](Json& manifest, List&) { manifest["inputs"]["subjects"] = 7; },
      [](Json& manifest, List&) { manifest["not_packed"] = {1}; }};
  for (std::size_t e = 0; e < std::size(edits); ++e) EXPECT_NE(packed(edits[e]), "") << e;
  EXPECT_NE(packed([](Json&, auto&) {}, false), "");
}

// A pack's subjects, meshes and scenes must be the campaign's recorded ones; only their paths differ.
TEST_F(PackTest, APackRunsItsOwnCampaign) {
  const Json spec = {
      {"subjects", {{{"name", "m"}, {"what", "/a/m.c"}, {"flags", {"-I/a"}}, {"environment", {{"CC", "x"}}}}}},
      {"mesh", {{"files", {"/a/x.off"}}}}};
  Json inputs = {{"subjects", {{{"name", "m"}, {"what", "subjects/m/m.c"}, {"flags", {"-Isubjects/m"}}}}},
                 {"mesh", {"mesh/0/x.off"}}};
  const Json there = spec_of_pack(spec, {{"inputs", inputs}});
  EXPECT_EQ(there["subjects"][0].dump(), R"({"name":"m","what":"subjects/m/m.c","flags":["-Isubjects/m"]})");
  EXPECT_EQ(there["mesh"]["files"][0], "mesh/0/x.off");
  for (const char* pointer : {"/subjects/0/name", "/mesh/0"}) {
    Json other = inputs;
    if (std::string(pointer) == "/mesh/0") {
      other.erase("mesh");
    } else {
      other[Json::json_pointer(pointer)] = "other";
    }
    EXPECT_THROW(spec_of_pack(spec, {{"inputs", other}}), std::runtime_error) << pointer;
  }
  inputs["scene"] = "scene/s.toml";
  EXPECT_THROW(spec_of_pack(spec, {{"inputs", inputs}}), std::runtime_error);
}

}  // namespace
}  // namespace graze::fuzz
