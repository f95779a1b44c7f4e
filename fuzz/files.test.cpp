// SPDX-License-Identifier: Apache-2.0
// Writing to a link, device, pipe or folder does not replace it with a file.
#include "fuzz/files.h"
#include "core/error.h"
#include "core/message_testing.h"
#include "core/stop.h"
#include "fuzz/campaign/result_files.h"
#include "fuzz/own_files.h"
#include "fuzz/sealed.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <future>

namespace graze::fuzz {
namespace {

namespace fs = std::filesystem;

class Files : public testing::Test {
 protected:
  Files() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~Files() override { fs::remove_all(folder_); }

  std::size_t count() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator()));
  }

  void TearDown() override { may_replace_foreign = false; }

  static std::string refusal(const fs::path& file) {
    return error_of([&] { write_whole(file, "text"); });
  }

  fs::path folder_ = fs::temp_directory_path() / ("graze-files-" + std::to_string(getpid()));
};

TEST_F(Files, AFileIsReplacedAndKeepsItsPermissions) {
  write_whole(folder_ / "a", "old");
  fs::permissions(folder_ / "a", fs::perms::owner_read | fs::perms::owner_write);
  write_whole(folder_ / "a", "new");
  EXPECT_EQ(read_whole(folder_ / "a"), "new");
  EXPECT_EQ(fs::status(folder_ / "a").permissions(), fs::perms::owner_read | fs::perms::owner_write);
  EXPECT_EQ(count(), 1u);
}

TEST_F(Files, LinksAreWrittenThrough) {
  fs::create_directories(folder_ / "far");
  write_whole(folder_ / "far/target", "text\nold");
  fs::create_symlink("far/target", folder_ / "link");
  fs::create_symlink("link", folder_ / "second");
  write_whole(folder_ / "second", "text\nnew");
  EXPECT_EQ(read_whole(folder_ / "far/target"), "text\nnew");
  fs::create_symlink("far/none_yet", folder_ / "dangling");
  write_whole(folder_ / "dangling", "first");
  EXPECT_EQ(read_whole(folder_ / "far/none_yet"), "first");
  for (const char* link : {"link", "second", "dangling"}) EXPECT_TRUE(fs::is_symlink(folder_ / link)) << link;
  fs::create_symlink("circle", folder_ / "circle");
  EXPECT_TRUE(names(refusal(folder_ / "circle"), {(folder_ / "circle").string(), "Too many levels of symbolic links"}));
}

TEST_F(Files, PipesStayPipes) {
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  auto reader = std::async(std::launch::async, [&] { return read_whole(pipe, NamedBy::user); });
  write_whole(pipe, "through", NamedBy::user);
  EXPECT_EQ(reader.get(), "through");
  EXPECT_TRUE(fs::is_fifo(pipe));
  EXPECT_EQ(count(), 1u);
}

// A pipe with a name that Graze chose is refused at once, without waiting for its other end.
TEST_F(Files, RecordsThatAreNoFilesAreRefused) {
  const fs::path pipe = folder_ / "summary.json";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  fs::create_symlink("/dev/zero", folder_ / "status.json");
  for (const fs::path& file : {pipe, folder_ / "status.json"}) {
    EXPECT_TRUE(names(refusal(file), {file.string(), "pipe or a device"}));
    EXPECT_THROW(read_whole(file), std::runtime_error);
    EXPECT_THROW(read_sealed(file, "remove it"), std::runtime_error);
    EXPECT_THROW(may_hold_campaign(folder_), std::runtime_error);
    EXPECT_THROW(expect_file(file), std::runtime_error);
  }
}

// The temporary file may be a hard link to another file, which must not change.
TEST_F(Files, APartThatIsAHardLinkIsReplaced) {
  write_whole(folder_ / "theirs", "precious");
  fs::create_hard_link(folder_ / "theirs", folder_ / "a.graze.part");
  write_whole(folder_ / "a", "new");
  EXPECT_EQ(read_whole(folder_ / "theirs"), "precious");
  EXPECT_EQ(fs::hard_link_count(folder_ / "theirs"), 1u);
  EXPECT_EQ(read_whole(folder_ / "a"), "new");
  EXPECT_EQ(count(), 2u);
  // A killed writer may have left a longer temporary file, none of whose text may remain.
  write_whole(folder_ / "a.graze.part", std::string(100'000, 'x'));
  write_whole(folder_ / "a", "newer");
  EXPECT_EQ(read_whole(folder_ / "a"), "newer");
  EXPECT_EQ(count(), 2u);
}

TEST_F(Files, ACopyIsWholeAndLeavesAForeignPart) {
  const std::string text(3'000'000, 'x');
  write_whole(folder_ / "from", text);
  fs::permissions(folder_ / "from", fs::perms::owner_read);
  const fs::path to = folder_ / "to", part = to.string() + kPart;
  fs::create_hard_link(folder_ / "from", part);
  copy_whole(folder_ / "from", to);
  EXPECT_EQ(read_whole(to), text);
  EXPECT_EQ(fs::status(to).permissions(), fs::perms::owner_read);
  EXPECT_EQ(fs::hard_link_count(folder_ / "from"), 1u);
  EXPECT_EQ(count(), 2u);
  EXPECT_THROW(copy_whole(folder_ / "none", to), std::runtime_error);
  write_whole(folder_ / "new", "new");
  for (const auto& make : {+[](const fs::path& at) { ASSERT_EQ(mkfifo(at.c_str(), 0600), 0); },
                           +[](const fs::path& at) { fs::create_directory(at); },
                           +[](const fs::path& at) { fs::create_symlink("from", at); }}) {
    make(part);
    EXPECT_TRUE(names(error_of([&] { copy_whole(folder_ / "new", to); }), {to.string(), part.string(), "in the way"}));
    EXPECT_TRUE(fs::remove(part));
    EXPECT_EQ(read_whole(to), text);
  }
}

TEST_F(Files, AChangeOfASealedFileIsNoticed) {
  const fs::path file = folder_ / "result.json";
  EXPECT_TRUE(read_sealed(file, "remove it").is_null());
  const Json json = {{"text", "\u00e4 \"x\""}, {"numbers", {1, -2, 0.1, 1e300, 18446744073709551615u, nullptr}}};
  const std::string text = sealed(json).dump(1) + "\n";
  write_whole(file, text);
  EXPECT_EQ(read_sealed(file, "remove it"), json);
  EXPECT_EQ(sealed(sealed(json)), sealed(json));
  EXPECT_EQ(std::prev(sealed(json).end()).key(), "checksum");
  write_whole(file, sealed(json).dump());  // in another layout
  EXPECT_EQ(read_sealed(file, "remove it"), json);
  std::size_t refused = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    std::string other = text;
    other[at] = other[at] == '7' ? '8' : '7';
    for (const std::string& changed : {other, text.substr(0, at)}) {
      std::ofstream(file) << changed;
      try {
        if (read_sealed(file, "remove it") == json) continue;  // white space, or text after the object, changed
        ADD_FAILURE() << changed;
      } catch (const std::runtime_error& error) {
        ++refused;
        EXPECT_TRUE(names(error.what(), {file.string(), "changed or damaged", "remove it"})) << error.what();
      }
    }
  }
  EXPECT_GT(refused, 200u);
  // Deep nesting must not overflow the stack.
  std::ofstream(file) << R"({"a":)" << std::string(1'000'000, '[') << std::string(1'000'000, ']')
                      << R"(,"checksum":""})";
  EXPECT_THROW(read_sealed(file, "remove it"), std::runtime_error);
  EXPECT_TRUE(parse_shallow(read_whole(file)).is_discarded());
  EXPECT_TRUE(parse_shallow("{").is_discarded());
  EXPECT_FALSE(parse_shallow("{}").is_discarded());
  EXPECT_TRUE(parse_shallow(std::string("{}\0{}", 5)).is_discarded());
  EXPECT_TRUE(parse_shallow(R"({"a": {"b": 1, "b": 1}})").is_discarded());
  EXPECT_FALSE(parse_shallow(R"({"a": {"b": 1}, "b": [{"a": 1}, {"a": 2}]})").is_discarded());
  EXPECT_EQ(parse_shallow(text)["checksum"], sealed(json)["checksum"]);
}

// The other end may never open, so a request to stop ends the wait.
TEST_F(Files, WaitingForAPipeStops) {
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  stop_requested = true;
  EXPECT_THROW(read_whole(pipe, NamedBy::user), Stopped);
  EXPECT_THROW(write_whole(pipe, "text", NamedBy::user), Stopped);
  const int reader = open(pipe.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  EXPECT_THROW(write_whole(pipe, std::string(1 << 20, 'x'), NamedBy::user), Stopped);  // more than the pipe holds
  close(reader);
  stop_requested = false;
}

// Creates a null device in the test's folder; only root may create devices.
TEST_F(Files, DevicesStayDevices) {
  const fs::path device = folder_ / "null";
  if (mknod(device.c_str(), S_IFCHR | 0600, makedev(1, 3)) != 0) GTEST_SKIP() << "may not create a device node";
  const int opened = open(device.c_str(), O_WRONLY | O_CLOEXEC);
  if (opened < 0) GTEST_SKIP() << "device nodes do not work in " << folder_;
  close(opened);
  write_whole(device, "text", NamedBy::user);
  EXPECT_TRUE(fs::is_character_file(device));
  fs::create_symlink("null", folder_ / "link");
  write_whole(folder_ / "link", "text", NamedBy::user);
  EXPECT_TRUE(fs::is_character_file(device));
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
  EXPECT_EQ(count(), 2u);
}

TEST_F(Files, FoldersAreRefusedInBothDirections) {
  fs::create_directories(folder_ / "sub");
  EXPECT_TRUE(names(refusal(folder_ / "sub"), {(folder_ / "sub").string(), "Is a directory"}));
  EXPECT_THROW(read_whole(folder_ / "sub"), std::runtime_error);
  EXPECT_EQ(read_whole(folder_ / "none"), "");
  EXPECT_EQ(read_whole(folder_ / "none" / "none"), "");
  EXPECT_NE(refusal(folder_ / "none" / "file").find("No such file or directory"), std::string::npos);
  EXPECT_EQ(count(), 1u);
}

// A limit on file sizes simulates a full disk.
TEST_F(Files, AFailureLeavesNothingBesideAndTheOldFile) {
  write_whole(folder_ / "a", "old");
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit small{1000, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  EXPECT_THROW(write_whole(folder_ / "a", std::string(5000, 'x')), std::runtime_error);
  setrlimit(RLIMIT_FSIZE, &before);
  EXPECT_EQ(read_whole(folder_ / "a"), "old");
  EXPECT_EQ(count(), 1u);
}

TEST_F(Files, OneHoldsAFoldersLock) {
  {
    const FolderLock held(folder_, FolderLock::WhenTaken::refuse);
    EXPECT_THROW(FolderLock(folder_, FolderLock::WhenTaken::refuse), std::runtime_error);
  }
  {
    const FolderLock shared(folder_, FolderLock::WhenTaken::share), too(folder_, FolderLock::WhenTaken::share);
    EXPECT_THROW(FolderLock(folder_, FolderLock::WhenTaken::refuse), std::runtime_error);
  }
  const FolderLock again(folder_, FolderLock::WhenTaken::refuse);
  EXPECT_THROW(FolderLock(folder_, FolderLock::WhenTaken::share), std::runtime_error);
  EXPECT_THROW(FolderLock(folder_ / "none", FolderLock::WhenTaken::wait), std::runtime_error);
}

TEST_F(Files, OfManyWritersOfOneFileEachWritesAWholeOne) {
  std::vector<std::future<void>> writers;
  std::vector<std::string> texts;
  for (char c = 'a'; c < 'e'; ++c) texts.emplace_back(300'000 + c, c);
  for (const std::string& text : texts)
    writers.push_back(std::async(std::launch::async, [&] {
      for (int i = 0; i < 50; ++i) write_whole(folder_ / "one", text);
    }));
  for (int i = 0; i < 200; ++i) {
    const std::string found = read_whole(folder_ / "one");
    EXPECT_TRUE(found.empty() || std::find(texts.begin(), texts.end(), found) != texts.end()) << found.size();
  }
  for (std::future<void>& writer : writers) writer.get();
  EXPECT_EQ(count(), 1u);
}

TEST_F(Files, GrazeKnowsItsOwn) {
  const auto replaces = [&](const std::string& there, const std::string& text) {
    write_whole(folder_ / "file", there);
    return may_replace(folder_ / "file", text);
  };
  EXPECT_TRUE(may_replace(folder_ / "missing", "text"));
  EXPECT_TRUE(may_replace("/dev/null", "text"));
  EXPECT_TRUE(replaces("", "graze-pairs 1\n"));
  EXPECT_TRUE(replaces("graze-pairs 1\n# mine\n", "graze-pairs 1\n0 0 0\n"));
  EXPECT_FALSE(replaces("0 0 0 1 1 1\n", "graze-pairs 1\n0 0 0\n"));
  EXPECT_FALSE(replaces("graze-pairs 1, and a poem", "{}"));
  EXPECT_TRUE(replaces("lane,group\n1,2\n", "lane,group\n"));
  EXPECT_FALSE(replaces("a,b\n1,2\n", "lane,group\n"));
  EXPECT_TRUE(replaces(R"({"pairs": 1, "seed": 2})", R"({"pairs": 3, "seed": 4, "invariants": []})"));
  EXPECT_TRUE(replaces(R"({"pairs": 1, "see)", R"({"pairs": 3, "seed": 4, "invariants": []})"));  // ours, but damaged
  for (const char* other : {R"({"seed": 1, "pairs": 2})", R"({"pairs": 1})", "[1]", "{", "{}", R"({"seed": 1, "pa)"})
    EXPECT_FALSE(replaces(other, R"({"pairs": 3, "seed": 4, "invariants": []})")) << other;
  EXPECT_TRUE(replaces("<!doctype html>\n<title>Graze: viewer</title>",
                       "<!DOCTYPE html>\n<title>Graze: discrepancy report</title>"));
  EXPECT_FALSE(replaces("<!DOCTYPE html>\n<title>My thesis</title>",
                        "<!DOCTYPE html>\n<title>Graze: discrepancy report</title>"));
  EXPECT_TRUE(replaces("<svg width=\"1\" fill=\"#777\"><g/></svg>", "<svg width=\"1\" fill=\"#777\"><text/></svg>"));
  EXPECT_FALSE(replaces("<svg width=\"2\"></svg>", "<svg width=\"1\" fill=\"#777\"><text/></svg>"));
  const std::string picture = std::string("\x89PNG....") + "PLTE" + std::string(24, 'c');
  EXPECT_TRUE(replaces(picture + "x", picture + "y"));
  EXPECT_FALSE(replaces(std::string("\x89PNG....") + "PLTE" + std::string(24, 'd'), picture));
  fs::create_symlink("file", folder_ / "link");
  EXPECT_FALSE(may_replace(folder_ / "link", "graze-pairs 1\n"));
}

// A file with the name of a campaign's file, or behind a link, is replaced only if it begins like the new text.
TEST_F(Files, ACampaignsFilesDoNotReplaceThoseOfAnother) {
  const std::string summary = "{\n \"spec\": {}\n}\n", status = "{\n \"state\": \"done\"\n}\n";
  write_whole(folder_ / "victim", "precious");
  fs::create_directories(folder_ / "linked");
  fs::create_symlink("../victim", folder_ / "linked/status.json");
  EXPECT_FALSE(may_hold_campaign(folder_ / "linked"));
  EXPECT_THROW(write_whole(folder_ / "linked/status.json", status), UsageError);
  fs::create_symlink("victim", folder_ / "link.csv");
  EXPECT_THROW(write_whole(folder_ / "link.csv", "lane,group\n"), UsageError);
  EXPECT_EQ(read_whole(folder_ / "victim"), "precious");
  std::ofstream(folder_ / "failures.json") << "[1, 2]";
  EXPECT_THROW(write_whole(folder_ / "failures.json", "{\n \"summary\": 1\n}\n"), UsageError);
  std::ofstream(folder_ / "summary.json") << "{\n \"spec\": damaged";
  write_whole(folder_ / "summary.json", summary);
  EXPECT_EQ(read_whole(folder_ / "summary.json"), summary);
  fs::create_directories(folder_ / "cases");
  for (const auto& [name, text] :
       {std::pair{"1.pairs", "graze-pairs 1\n"}, {"1.maps.json", R"({"title": "", "pair": 1})"}}) {
    std::ofstream(folder_ / "cases" / name) << R"({"a": 1})";
    EXPECT_THROW(write_whole(folder_ / "cases" / name, text), UsageError) << name;
    EXPECT_EQ(read_whole(folder_ / "cases" / name), R"({"a": 1})");
  }
  may_replace_foreign = true;
  write_whole(folder_ / "linked/status.json", status);
  may_replace_foreign = false;
  EXPECT_EQ(read_whole(folder_ / "victim"), status);
}

TEST_F(Files, ResultsGoIntoFoldersThatAreTheirOwnOrEmpty) {
  const fs::path out = folder_ / "out";
  EXPECT_TRUE(may_fill(out, {"tune.json"}));
  fs::create_directories(out / "cases/of");
  write_whole(out / "tune.json.graze.part", "what a killed write left");
  EXPECT_TRUE(may_fill(out, {"tune.json"}));
  EXPECT_TRUE(may_hold_campaign(out));
  for (const char* theirs : {"movie.mkv.part", "thesis.part/chapter", "thesis.graze.part/chapter"}) {
    fs::create_directories((out / theirs).parent_path());
    write_whole(out / theirs, "text");
    EXPECT_FALSE(may_fill(out, {"tune.json"})) << theirs;
    EXPECT_FALSE(may_hold_campaign(out)) << theirs;
    fs::remove(out / theirs);
  }
  fs::create_symlink("cases", out / "link.graze.part");
  EXPECT_FALSE(may_fill(out, {"tune.json"}));
  fs::remove(out / "link.graze.part");
  EXPECT_TRUE(may_fill(out, {"tune.json"}));
  write_whole(out / "cases/of/mine", "text");
  EXPECT_FALSE(may_fill(out, {"tune.json"}));
  EXPECT_FALSE(may_hold_campaign(out));
  write_whole(out / "tune.json", "{}");
  EXPECT_TRUE(may_fill(out, {"tune.json"}));
  EXPECT_FALSE(may_hold_campaign(out));
  fs::create_directories(out / "rank-0");
  EXPECT_TRUE(may_hold_campaign(out));
  EXPECT_FALSE(may_fill("/", {"tune.json"}));
  EXPECT_FALSE(may_hold_campaign("/"));
}

}  // namespace
}  // namespace graze::fuzz
