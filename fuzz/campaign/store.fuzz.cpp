// SPDX-License-Identifier: Apache-2.0
// Edits a campaign's store at random. Opening the store must succeed, or fail with one line that names the file; with
// --discard-damaged it must succeed. With the missing batches added, the results must equal the whole store's.
#include "fuzz/campaign/store.h"

#include <unistd.h>

#include "core/error.h"
#include "core/fuzz_target.h"
#include "fuzz/campaign/campaign.h"
#include "fuzz/campaign/cpu_engine.h"

namespace graze::fuzz {
namespace {

namespace fs = std::filesystem;

// A store of two sources in five rows, in two states: after a normal end, and with the log that a killed run leaves.
class Whole {
 public:
  Whole() {
    folder_ = fs::path(access("/dev/shm", W_OK) == 0 ? "/dev/shm" : fs::temp_directory_path()) /
              ("graze-store-fuzz-" + std::to_string(getpid()));
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    campaign_.seed = 3;
    campaign_.sources = strata::stratum_sources(campaign_.seed, 60, {"near_edge_edge", "extreme_scale"});
    campaign_.under_test = &under_test_;
    campaign_.threads = 1;
    campaign_.directory = folder_;
    campaign_.spec = campaign_spec(campaign_);
    campaign_.build = {{"commit", "c"}};
    for (const PairRange& range : kRows) {
      counts_.push_back(judge(campaign_, range.source, range.pairs, [&](std::size_t i) { return range.first + i; }));
    }
    {
      Store store = opened();
      for (std::size_t row = 0; row < std::size(kRows); ++row) store.commit(kRows[row], counts_[row]);
      killed_ = {read_whole(file()), read_whole(log())};
      results_ = results(store);
    }
    ended_ = {read_whole(file()), ""};
  }
  ~Whole() { fs::remove_all(folder_); }

  fs::path file() const { return folder_ / kDatabase; }
  fs::path log() const { return file().string() + "-wal"; }
  StoreSpec spec() const { return store_spec(campaign_); }
  Store opened() const { return Store(spec()); }

  struct Files {
    std::string database, log;
  };
  const Files& files(bool killed) const { return killed ? killed_ : ended_; }
  void write(const Files& files) const {
    for (const auto& entry : fs::directory_iterator(folder_)) fs::remove_all(entry);
    write_whole(file(), files.database);
    if (!files.log.empty()) write_whole(log(), files.log);
  }

  // Commits the missing batches of a store that opened; then it must equal the whole store.
  void check(Store& store) const {
    std::size_t rows = 0;
    for (std::size_t row = 0; row < std::size(kRows); ++row) {
      if (store.holds(kRows[row])) continue;
      store.commit(kRows[row], counts_[row]);
      ++rows;
    }
    reached(rows);
    must_hold(store.gaps(0).empty() && store.gaps(1).empty(), "only whole batches are missing");
    must_hold(results(store) == results_, "the results are those of the whole store");
  }

 private:
  // The sizes are chosen so that adjacent ranges do not merge into one row.
  static constexpr PairRange kRows[] = {{0, 0, 16}, {0, 16, 8}, {0, 24, 6}, {1, 0, 20}, {1, 20, 10}};

  static Json results(const Store& store) {
    Json signatures = Json::object();
    for (const auto& [key, found] : store.signatures()) {
      signatures[key] = {found.count};
      for (const CaseKey& kept : found.cases) signatures[key].push_back({kept.source, kept.index});
    }
    return {store.results(), store.oracle(), signatures};
  }

  fs::path folder_;
  SelectedLanes under_test_ = select_lanes({"moller_1997/f32/cpu", "projected_sat/f32/cpu"}, Executor::twin);
  Campaign campaign_;
  std::vector<StoredCounts> counts_;
  Files ended_, killed_;
  Json results_;
};

// Six bytes describe an edit: the kind, the place (three bytes) and the value (two bytes).
void edit(std::string& bytes, std::string_view how) {
  const auto byte = [&](std::size_t i) { return static_cast<std::size_t>(static_cast<unsigned char>(how[i])); };
  if (bytes.empty()) return;
  const std::size_t at = (byte(1) << 16 | byte(2) << 8 | byte(3)) % bytes.size(), value = byte(4) << 8 | byte(5);
  switch (byte(0) % 5) {
    case 0:
      bytes[at] = static_cast<char>(bytes[at] ^ 1 << value % 8);
      break;
    case 1:
      bytes[at] = static_cast<char>(value);
      break;
    case 2:
      bytes.resize(at);
      break;
    case 3:
      bytes.replace(at, 512, std::string(512, static_cast<char>(value)));
      break;
    default:
      bytes.replace(at, 512, bytes.substr(value * 64 % bytes.size(), 512));
  }
}

// The error on opening; empty if the store opened and passed the check.
std::string refusal(const Whole& whole) {
  try {
    Store store = whole.opened();
    whole.check(store);
    return "";
  } catch (const UsageError&) {
    must_hold(false, "a damaged store is not mistaken for another campaign's");
  } catch (const std::runtime_error& error) {
    const std::string said = error.what();
    must_be_one_line(said);
    must_hold(said.find(whole.file().string()) != said.npos, "an error names the file");
    return said;
  }
  return "";
}

const RegisterFuzzTarget kStore("store", [](std::string_view bytes) {
  static const Whole whole;
  if (bytes.empty()) return;
  Whole::Files files = whole.files(bytes[0] % 2 != 0);
  for (bytes.remove_prefix(1); bytes.size() >= 6; bytes.remove_prefix(6))
    edit(bytes[0] & 64 ? files.log : files.database, bytes);
  whole.write(files);
  const std::string said = refusal(whole);
  reached(16 + said.size() % 512);
  if (said.find("--discard-damaged") == said.npos) return;
  try {
    must_hold(discard_damaged(whole.spec()).has_value(), "only a damaged store is reported as damaged");
  } catch (const std::runtime_error& error) {
    must_be_one_line(error.what());
    return;
  }
  must_hold(refusal(whole).empty(), "a store opens once its damaged batches are discarded");
});

}  // namespace
}  // namespace graze::fuzz
