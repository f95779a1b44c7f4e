// SPDX-License-Identifier: Apache-2.0
// Tests that a damaged store is never accepted, and that batches with correct checksums can be kept.
#include "fuzz/campaign/store.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <functional>
#include <map>

#include "core/error.h"
#include "core/message_testing.h"
#include "fuzz/campaign/campaign_testing.h"
#include "fuzz/campaign/cpu_engine.h"
#include "fuzz/campaign/result_files.h"

namespace graze::fuzz {
namespace {

namespace fs = std::filesystem;

class StoreTest : public testing::Test {
 protected:
  StoreTest() {
    std::string name = testing::UnitTest::GetInstance()->current_test_info()->name();
    std::replace(name.begin(), name.end(), '/', '-');
    // The folder is in memory if possible, because opening each of 100,000 databases on a disk takes milliseconds.
    const fs::path folder = access("/dev/shm", W_OK) == 0 ? "/dev/shm" : fs::temp_directory_path();
    root_ = folder / ("graze-store-" + name + std::to_string(getpid()));
    fs::remove_all(root_);
  }
  ~StoreTest() override { fs::remove_all(root_); }

  Campaign campaign(const std::string& name, std::uint64_t pairs = 1200) const {
    Campaign c = campaign_in(root_ / name, under_test_,
                             strata::stratum_sources(3, pairs, {"near_edge_edge", "degenerate", "extreme_scale"}), 3);
    c.threads = 1;
    c.build = {{"commit", "c"}, {"flags", "-O3"}};
    return c;
  }

  static std::string run(const Campaign& c) {
    const std::atomic<bool> go_on{false};
    return run_campaign(c, go_on, [](const Progress&) {}).summary.dump();
  }

  static void commit(Store& store, const Campaign& c, const PairRange& range) {
    store.commit(range, judge(c, range.source, range.pairs, [&](std::size_t i) { return range.first + i; }));
  }

  // A campaign of three sources with 400 pairs each, in seven rows (first, pairs): (0, 300), (300, 80) and (380, 20)
  // for each of two sources, and (0, 400) for the third.
  Campaign in_seven_rows(const std::string& name) const {
    Campaign c = campaign(name);
    Store store(store_spec(c));
    for (int source : {0, 1}) {
      for (const auto& [first, pairs] : {std::pair{0, 300}, {300, 80}, {380, 20}})
        commit(store, c, {source, static_cast<std::uint64_t>(first), static_cast<std::uint64_t>(pairs)});
    }
    commit(store, c, {2, 0, 400});
    return c;
  }

  static fs::path file(const Campaign& c) { return c.directory / "campaign.sqlite"; }
  static std::int64_t rows(const Campaign& c) {
    return SQLite::Database(file(c).string()).execAndGet("SELECT count(*) FROM batch").getInt64();
  }

  // The error on opening; empty if there is none.
  static std::string refusal(const Campaign& c) {
    try {
      Store store(store_spec(c));
    } catch (const UsageError& error) {
      return std::string("wrong use: ") + error.what();
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  static void expect_one_line_of_damage(const Campaign& c, const std::string& what) {
    const std::string said = refusal(c);
    EXPECT_TRUE(names(said, {file(c).string(), "damaged", "--discard-damaged"})) << what;
  }

  fs::path root_;
  SelectedLanes under_test_ = select_lanes({"moller_1997/f32/cpu", "projected_sat/f32/cpu"}, Executor::twin);
};

TEST_F(StoreTest, EditsAreFoundOutAndWhatChecksIsKept) {
  const std::string whole = run(campaign("whole"));
  const Campaign c = in_seven_rows("edited");
  const std::string bytes = read_whole(file(c));
  struct Edit {
    const char* sql;
    std::size_t kept;
  };
  for (const auto& [sql, kept] :
       {Edit{"UPDATE batch SET source = 2000000 WHERE id = 2", 6}, Edit{"UPDATE batch SET source = -1 WHERE id = 2", 6},
        Edit{"UPDATE batch SET source = 1 WHERE id = 2", 6}, Edit{"UPDATE batch SET pairs = pairs + 1 WHERE id = 2", 6},
        Edit{"UPDATE batch SET pairs = -1 WHERE id = 2", 6}, Edit{"UPDATE batch SET first = 299 WHERE id = 2", 6},
        Edit{"UPDATE batch SET first = 0", 3}, Edit{"UPDATE batch SET checksum = checksum + 1 WHERE id = 5", 6},
        Edit{"UPDATE batch SET counts = zeroblob(9)", 0}, Edit{"UPDATE batch SET counts = 7 WHERE id = 7", 6},
        Edit{"INSERT INTO batch SELECT 8, source, first, pairs, counts, checksum FROM batch WHERE id = 3", 7},
        Edit{"UPDATE campaign SET text = replace(text, 'seed', 'sead')", 7}, Edit{"DELETE FROM campaign", 7},
        Edit{"UPDATE campaign SET checksum = 1", 7}, Edit{"INSERT INTO campaign SELECT * FROM campaign", 7},
        Edit{"DROP TABLE campaign", 7}, Edit{"DROP TABLE batch", 0}, Edit{"DELETE FROM campaign; DELETE FROM batch", 0},
        Edit{"ALTER TABLE batch RENAME TO rows; CREATE VIEW batch(id, source, first, pairs, counts, checksum) AS WITH "
             "RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT id, source, first, pairs, counts, "
             "checksum FROM rows, n",
             0}}) {
    write_whole(file(c), bytes);
    SQLite::Database(file(c).string(), SQLite::OPEN_READWRITE).exec(sql);
    expect_one_line_of_damage(c, sql);
    const auto salvage = discard_damaged(store_spec(c));
    ASSERT_TRUE(salvage) << sql;
    EXPECT_EQ(salvage->batches, kept) << sql;
    const std::int64_t pairs =
        SQLite::Database(file(c).string()).execAndGet("SELECT ifnull(sum(pairs), 0) FROM batch").getInt64();
    EXPECT_EQ(salvage->pairs, static_cast<std::uint64_t>(pairs)) << sql;
    EXPECT_TRUE(fs::exists(salvage->damaged)) << sql;
    EXPECT_EQ(refusal(c), "") << sql;
    EXPECT_FALSE(discard_damaged(store_spec(c))) << sql;
    EXPECT_EQ(run(c), whole) << sql;
  }
}

// A source may have a single pair.
TEST_F(StoreTest, OnePairOfASourceIsEnough) {
  const Campaign c = campaign("three", 3);
  const std::string whole = run(c);
  EXPECT_EQ(refusal(c), "");
  EXPECT_EQ(run(c), whole);
}

// The pairs of lost rows are judged again.
TEST_F(StoreTest, GapsAreFilled) {
  const std::string whole = run(campaign("whole"));
  for (const char* sql :
       {"DELETE FROM batch WHERE id = 1", "DELETE FROM batch WHERE id IN (2, 6, 7)", "DELETE FROM batch"}) {
    const Campaign c = in_seven_rows("gap");
    SQLite::Database(file(c).string(), SQLite::OPEN_READWRITE).exec(sql);
    EXPECT_EQ(run(c), whole) << sql;
    fs::remove_all(c.directory);
  }
}

// These rows have correct checksums, but are outside the source's 400 pairs, or outside the shard's share.
TEST_F(StoreTest, RangesThatTheStoreDoesNotHoldAreFoundOut) {
  int number = 0;
  const auto refused = [&](const Shard& shard, const PairRange& range) {
    Campaign c = campaign("range" + std::to_string(number++));
    c.shard = shard;
    {
      Store store(store_spec(c));
      commit(store, c, range);
    }
    return refusal(c);
  };
  const Shard middle{2, 4};  // 100 to 200
  for (const PairRange& range : {PairRange{0, 0, 400}, {0, 399, 1}, {1, 200, 200}})
    EXPECT_EQ(refused({}, range), "") << range.first;
  for (const PairRange& range : {PairRange{0, 0, 401}, {0, 399, 2}, {0, 400, 1}, {0, 500, 3}})
    EXPECT_TRUE(names(refused({}, range), {"this store's share", "--discard-damaged"})) << range.first;
  for (const PairRange& range : {PairRange{0, 100, 100}, {0, 199, 1}})
    EXPECT_EQ(refused(middle, range), "") << range.first;
  for (const PairRange& range : {PairRange{0, 99, 2}, {0, 0, 50}, {0, 199, 2}, {0, 200, 1}, {0, 300, 10}})
    EXPECT_TRUE(names(refused(middle, range), {"this store's share", "--discard-damaged"})) << range.first;
}

TEST(FirstDifference, NamesThePlaceAndBothValues) {
  EXPECT_EQ(first_difference({{"scene", "B\u00e4r"}}, {{"scene", 7}}), "scene is 7, not \"B\u00e4r\"");
  EXPECT_EQ(first_difference({{"lanes", {"a", "b"}}}, {{"lanes", {"a"}}}), "lanes/1 is none, not \"b\"");
  EXPECT_EQ(first_difference({{"a", 1}}, {{"a", 1}, {"b", true}}), "b is true, not none");
  const Json none = {{"flags", Json::array()}}, some = {{"flags", {"-O0"}}};
  EXPECT_EQ(first_difference(none, some), "flags/0 is \"-O0\", not none");
  EXPECT_EQ(first_difference(some, none), "flags/0 is none, not \"-O0\"");
  EXPECT_EQ(first_difference({{"a", 1}}, {{"a", 1}, {"flags", Json::array()}}), "flags is null, not none");
}

// A user's file, link, pipe or folder may have the name that Graze needs to set a database aside or prepare one.
TEST_F(StoreTest, DiscardingDamageReplacesAndRemovesNothing) {
  const std::string whole = run(campaign("whole"));
  const Campaign c = in_seven_rows("taken");
  const std::string bytes = read_whole(file(c)), damaged = bytes.substr(0, bytes.size() / 2);
  const fs::path taken = file(c).string() + ".damaged", second = taken.string() + "-2", third = taken.string() + "-3";
  write_whole(root_ / "theirs", "precious");
  const std::map<std::string, std::function<void(const fs::path&)>> things = {
      {"file", [](const fs::path& at) { write_whole(at, "precious"); }},
      {"hard link", [&](const fs::path& at) { fs::create_hard_link(root_ / "theirs", at); }},
      {"link", [&](const fs::path& at) { fs::create_symlink(root_ / "theirs", at); }},
      {"dangling link", [&](const fs::path& at) { fs::create_symlink(root_ / "nothing", at); }},
      {"pipe", [](const fs::path& at) { ASSERT_EQ(mkfifo(at.c_str(), 0600), 0); }},
      {"folder", [](const fs::path& at) { fs::create_directory(at); }}};
  for (const auto& [what, make] : things) {
    std::vector<std::pair<fs::path, struct stat>> before;
    for (const fs::path& at :
         {taken, fs::path(file(c).string() + ".part"), fs::path(file(c).string() + "-wal.damaged")}) {
      make(at);
      ASSERT_EQ(lstat(at.c_str(), &before.emplace_back(at, (struct stat){}).second), 0);
    }
    for (const fs::path& place : {second, third}) {
      write_whole(file(c), damaged);
      write_whole(file(c).string() + "-wal", "no log");
      const auto salvage = discard_damaged(store_spec(c));
      ASSERT_TRUE(salvage) << what;
      EXPECT_EQ(salvage->damaged, place) << what;
      EXPECT_EQ(read_whole(place), damaged) << what;
      EXPECT_EQ(read_whole(file(c).string() + "-wal" + place.string().substr(file(c).string().size())), "no log")
          << what;
      EXPECT_EQ(run(c), whole) << what;
    }
    for (const auto& [at, was] : before) {
      struct stat is {};
      ASSERT_EQ(lstat(at.c_str(), &is), 0) << what << ' ' << at;
      EXPECT_EQ(std::pair(is.st_ino, is.st_size), std::pair(was.st_ino, was.st_size)) << what << ' ' << at;
      fs::remove(at);
    }
    for (const fs::path& place : {second, third}) {
      fs::remove(place);
      fs::remove(file(c).string() + "-wal" + place.string().substr(file(c).string().size()));
    }
  }
  EXPECT_EQ(read_whole(root_ / "theirs"), "precious");
  EXPECT_FALSE(fs::exists(root_ / "nothing"));
}

// SQLite would read the log beside the link's target.
TEST_F(StoreTest, ADamagedDatabaseBehindALinkIsMendedThere) {
  const std::string whole = run(campaign("whole"));
  const Campaign c = in_seven_rows("linked");
  fs::create_directory(root_ / "disk");
  fs::rename(file(c), root_ / "disk/store");
  fs::create_symlink("../disk/store", file(c));
  const std::string bytes = read_whole(file(c));
  write_whole(root_ / "disk/store", bytes.substr(0, bytes.size() / 2));
  const auto salvage = discard_damaged(store_spec(c));
  ASSERT_TRUE(salvage);
  EXPECT_EQ(salvage->damaged.filename(), "store.damaged");
  EXPECT_EQ(run(c), whole);
  EXPECT_TRUE(fs::is_symlink(file(c)));
}

// If Graze followed this link, it would write and remove cases in a user's folder.
TEST_F(StoreTest, ALinkInPlaceOfTheFolderOfCasesIsRefused) {
  const Campaign c = campaign("cases_elsewhere");
  fs::create_directories(root_ / "theirs_too");
  write_whole(root_ / "theirs_too/precious", "precious");
  fs::create_directory(c.directory);
  fs::create_directory_symlink("../theirs_too", c.directory / "cases");
  EXPECT_TRUE(names(error_of([&] { run(c); }), {"cases", "link"}));
  EXPECT_EQ(read_whole(root_ / "theirs_too/precious"), "precious");
  EXPECT_EQ(std::distance(fs::directory_iterator(root_ / "theirs_too"), {}), 1);
}

// Opening the database read-only leaves an index and an empty log behind.
TEST_F(StoreTest, ReadingRemovesWhatOtherReadersOfTheDatabaseLeft) {
  const Campaign c = campaign("read");
  run(c);
  SQLite::Database(file(c).string(), SQLite::OPEN_READONLY).execAndGet("SELECT count(*) FROM batch");
  const std::string name = file(c).string();
  ASSERT_TRUE(fs::exists(name + "-shm") && fs::exists(name + "-wal"));
  EXPECT_EQ(recorded_store(c.directory).spec, c.spec);
  EXPECT_FALSE(fs::exists(name + "-shm") || fs::exists(name + "-wal"));
}

TEST_F(StoreTest, RemovingAStoreLeavesWhatOthersPutBesideIt) {
  const Campaign c = in_seven_rows("scratch");
  const fs::path left = file(c).string() + kPart;
  write_whole(left, "of a killed run");
  write_whole(file(c).string() + ".part", "precious");
  remove_store(c.directory);
  EXPECT_FALSE(fs::exists(left));
  EXPECT_FALSE(fs::exists(file(c)));
  fs::create_directory(left);
  write_whole(c.directory / "status.json", "{\"mine\": 1}");
  remove_store(c.directory);
  EXPECT_TRUE(fs::exists(c.directory / "status.json"));
  EXPECT_TRUE(fs::exists(left));
  EXPECT_EQ(read_whole(file(c).string() + ".part"), "precious");
}

// Writing the log back fails, as on a full disk. The rows remain in the log.
TEST_F(StoreTest, AStoreThatCannotBeFinishedSaysSo) {
  const Campaign c = campaign("full");
  Store store(store_spec(c));
  commit(store, c, {0, 0, 400});
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handled = std::signal(SIGXFSZ, SIG_IGN);
  rlimit small = before;
  small.rlim_cur = 4096;
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  EXPECT_THROW(store.finish(), std::runtime_error);
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, handled);
  store.finish();
  const fs::path copy = root_ / "copy";
  fs::create_directory(copy);
  fs::copy_file(file(c), copy / "campaign.sqlite");  // one file is the whole store
  std::uint64_t pairs = 0;
  StoreSpec spec = store_spec(c);
  spec.directory = copy;
  for_each_row(spec, [&](const PairRange& range, const StoredCounts&) { pairs += range.pairs; });
  EXPECT_EQ(pairs, 400u);
}

// SQLite would overwrite pages of an undamaged database with pages from another database's log.
TEST_F(StoreTest, TheLogOfAnotherDatabaseIsRefused) {
  const Campaign c = campaign("whole");
  const std::string whole = run(c);
  {
    const Campaign other = campaign("other");
    Store store(store_spec(other));
    commit(store, other, {0, 0, 400});
    fs::copy_file(file(other).string() + "-wal", file(c).string() + "-wal");
  }
  const std::string bytes = read_whole(file(c));
  EXPECT_THROW(recorded_store(c.directory), DamagedStore);
  EXPECT_THROW(run(c), DamagedStore);
  EXPECT_EQ(read_whole(file(c)), bytes);
  const auto salvage = discard_damaged(store_spec(c));
  ASSERT_TRUE(salvage);
  EXPECT_EQ(salvage->pairs, 1200u);
  EXPECT_EQ(run(c), whole);
}

// Another user could guess the folder's name and create it first.
TEST_F(StoreTest, AScratchThatIsALinkIsRefused) {
  Campaign c = campaign("shard");
  c.shard = {1, 2};
  c.scratch = root_ / "scratch";
  fs::create_directories(root_ / "theirs_as_well");
  write_whole(root_ / "theirs_as_well/timings.json", "precious");
  fs::create_directory_symlink("theirs_as_well", c.scratch);
  EXPECT_THROW(run(c), std::runtime_error);
  EXPECT_EQ(read_whole(root_ / "theirs_as_well/timings.json"), "precious");
  fs::remove(c.scratch);
  run(c);
  EXPECT_FALSE(fs::exists(c.scratch));
}

TEST_F(StoreTest, DamageOfAnotherCampaignIsNoReasonToDiscardIt) {
  in_seven_rows("taken");
  Campaign other = campaign("taken", 1500);
  SQLite::Database(file(other).string(), SQLite::OPEN_READWRITE).exec("UPDATE campaign SET checksum = 1");
  const std::string bytes = read_whole(file(other));
  EXPECT_THROW(discard_damaged(store_spec(other)), std::runtime_error);
  EXPECT_EQ(read_whole(file(other)), bytes);
  other = campaign("taken");
  other.build["flags"] = "-g";
  EXPECT_THROW(discard_damaged(store_spec(other)), std::runtime_error);
}

TEST_F(StoreTest, OtherBuildsFormatsAndProcessesAreRefused) {
  Campaign c = in_seven_rows("mine");
  const std::string flags = c.build["flags"].dump();
  c.build["flags"] = "-g";
  EXPECT_TRUE(
      names(refusal(c), {"wrong use", c.directory.string(), "another build", "flags", "\"-g\"", flags, "--out"}));
  c.spec["seed"] = 9;
  c.spec["strata"] = {"lattice"};
  EXPECT_TRUE(names(refusal(c), {"wrong use", c.directory.string(), "another campaign", "seed", "9", "3", "--out"}));
  c = campaign("mine");
  {
    const Store held(store_spec(c));
    EXPECT_TRUE(names(refusal(c), {c.directory.string(), "another process"}));
  }
  SQLite::Database(file(c).string(), SQLite::OPEN_READWRITE).exec("PRAGMA user_version = 3");
  EXPECT_TRUE(names(refusal(c), {file(c).string(), "format 6", "format 3", "--out"}));
}

// Crashes and other failures are counted only for foreign lanes, even if our own lanes precede them.
TEST_F(StoreTest, ResultsOfForeignLanesSayMore) {
  struct Foreign : ForeignCode {
    void decide(const Pair*, std::size_t, std::uint64_t*, std::uint64_t*) override {}
    Verdict failure(const Pair&) override { return Verdict::crashed; }
  };
  static Foreign code;
  static const AlgorithmInfo info{"foreign", "test", "", "", "", false};
  add_lanes({{"", &info, Scalar::f32, Variant::cpu, "", {}, -1, code, false, false, true, 0, ""}});
  const std::string id = lanes().back().id;
  StoreSpec spec = store_spec(campaign("foreign"));
  spec.lanes = {"moller_1997/f32/cpu", id};
  const Json rows = Store(spec).results()["strata"]["degenerate"]["lanes"];
  for (const char* what : {"crashed", "timed_out", "unstable", "by_convention"}) {
    EXPECT_EQ(rows[id].value(what, -1), 0) << what;
    EXPECT_FALSE(rows["moller_1997/f32/cpu"].contains(what)) << what;
  }
}

// Rows of equal batches merge like digits that carry in a binary counter.
TEST_F(StoreTest, RowsMergeAndResultsStayTheSame) {
  const Campaign parts = campaign("parts"), whole = campaign("whole");
  Json results;
  {
    Store store(store_spec(parts));
    for (std::uint64_t first = 0; first < 400; first += 25) {
      EXPECT_EQ(store.done(0), first);
      EXPECT_EQ(store.missing(0, 1000).first, first);
      commit(store, parts, {0, first, 25});
    }
    results = store.results();
  }
  EXPECT_EQ(rows(parts), 1);
  Store one(store_spec(whole)), again(store_spec(parts));
  commit(one, whole, {0, 0, 400});
  EXPECT_EQ(results.dump(), one.results().dump());
  EXPECT_EQ(again.results().dump(), one.results().dump());
  EXPECT_EQ(again.oracle().dump(), one.oracle().dump());
  ASSERT_GT(one.signatures().size(), 5u);
  for (const auto& [key, found] : one.signatures()) {
    EXPECT_EQ(again.signatures().at(key).count, found.count);
    EXPECT_EQ(again.signatures().at(key).cases, found.cases);
  }
}

// These rows have correct checksums, but impossible contents.
TEST_F(StoreTest, SumsThatDoNotAgreeAndIndicesOutOfRangeAreFoundOut) {
  const Campaign c = campaign("sums");
  const PairRange range{2, 100, 200};
  const std::string bytes =
      to_bytes(StoredCounts(judge(c, 2, range.pairs, [&](std::size_t i) { return range.first + i; })));
  EXPECT_EQ(to_bytes(from_bytes(bytes, range, Axis::scale, 2)), bytes);
  const auto refused = [&](const char* pointer, const Json& value) {
    Json all = Json::from_cbor(bytes);
    Json& place = all.at(Json::json_pointer(pointer));
    EXPECT_NE(place, value) << pointer;
    place = value;
    std::string edited;
    Json::to_cbor(all, edited);
    EXPECT_THROW(from_bytes(edited, range, Axis::scale, 2), Damaged) << pointer << " " << value;
  };
  const Json all = Json::from_cbor(bytes);
  for (const char* tally : {"/0", "/1"}) {
    const std::string row = std::string(tally) + "/0";
    const std::uint64_t pairs = all.at(Json::json_pointer(row + "/1"));
    refused((row + "/0").c_str(), -65);
    refused((row + "/0").c_str(), 65);
    refused((row + "/1").c_str(), pairs + 1000);
    refused((row + "/1").c_str(), pairs - 1);
    refused((row + "/2").c_str(), pairs + 1);
    refused((row + "/3").c_str(), Json::parse("[[2, 0, 0, 1, 0]]"));
    refused((row + "/3").c_str(), Json::parse("[[-1, 0, 0, 1, 0]]"));
    refused((row + "/3").c_str(), Json::parse("[[0, 0, 0, 201, 0]]"));
    refused(tally, Json::array());
  }
  refused("/2/0/1", 0);
  refused("/2/0/1", 201);
  refused("/2/0/2/0", 99);
  refused("/2/0/2/0", 300);
  refused("/2/0/2", Json::array());
  refused("/2/1/0", all[2][0][0]);
  const std::string key = all[2][0][0];
  refused("/2/0/0", "no signature");
  refused("/2/0/0", key + "\x87");  // not UTF-8
  refused("/2/0/0", "none/22/skew/+2^2147483648/" + key.substr(key.rfind('/', key.find(':')) + 1));
  refused("/4", 201);
  refused("/7", "device");
  EXPECT_THROW(from_bytes("\x9b\x7f\xff\xff\xff\xff\xff\xff\xff", range, Axis::scale, 2),
               Damaged);  // needs more memory than any machine has
  EXPECT_THROW(from_bytes(bytes.substr(1), range, Axis::scale, 2), Damaged);
  EXPECT_THROW(from_bytes(bytes, {2, 100, 199}, Axis::scale, 2), Damaged);
  EXPECT_THROW(from_bytes(bytes, range, Axis::none, 2), Damaged);
}

// Flips each bit of a small campaign's database. Either the results are the same, or opening fails with a one-line
// error. Each part of the test flips some of the bits.
class EveryBit : public StoreTest, public testing::WithParamInterface<int> {
 protected:
  static constexpr int kParts = 8;
};

TEST_P(EveryBit, ChangesNothingInSilence) {
  const Campaign c = campaign("flipped", 12);
  const std::string whole = run(c);
  // Small pages leave less unused space.
  SQLite::Database(file(c).string(), SQLite::OPEN_READWRITE)
      .exec("PRAGMA journal_mode = DELETE; PRAGMA page_size = 2048; VACUUM");
  const auto results = [&] {
    Store store(store_spec(c));
    for (int s = 0; s < 3; ++s) {
      if (store.done(s) < c.sources[static_cast<std::size_t>(s)].pairs) return Json();
    }
    Json signatures = Json::object();
    for (const auto& [key, found] : store.signatures()) {
      signatures[key] = {found.count};
      for (const CaseKey& kept : found.cases) signatures[key].push_back({kept.source, kept.index});
    }
    return Json{store.results(), store.oracle(), signatures};
  };
  const Json expected = results();
  const std::string bytes = read_whole(file(c));
  ASSERT_GE(bytes.size() * 8, 32768u);
  std::size_t refused = 0, same = 0, again = 0;
  for (std::size_t bit = static_cast<std::size_t>(GetParam()); bit < bytes.size() * 8; bit += kParts) {
    std::string flipped = bytes;
    flipped[bit / 8] = static_cast<char>(flipped[bit / 8] ^ 1 << bit % 8);
    fs::remove(file(c).string() + "-wal");
    write_whole(file(c), flipped);
    try {
      const Json found = results();
      if (found.is_null()) {
        ++again;
        ASSERT_EQ(run(c), whole) << "bit " << bit;
      } else {
        ++same;
        ASSERT_EQ(found, expected) << "bit " << bit;
      }
    } catch (const UsageError& error) {
      FAIL() << "bit " << bit << ": " << error.what();
    } catch (const std::exception& error) {
      ++refused;
      const std::string said = error.what();
      ASSERT_TRUE(names(said, {file(c).string()})) << "bit " << bit;
    }
  }
  std::cout << refused << " refused, " << same << " the same, " << again << " judged again\n";
  EXPECT_GT(refused, 100u);  // the rest is mostly unused space
}

INSTANTIATE_TEST_SUITE_P(, EveryBit, testing::Range(0, 8));

}  // namespace
}  // namespace graze::fuzz
