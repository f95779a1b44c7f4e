// SPDX-License-Identifier: Apache-2.0
#include "fuzz/hunt/round.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <unistd.h>

#include <bitset>
#include <cerrno>
#include <csignal>
#include <cstring>

#include "core/cannot.h"
#include "core/fnv1a.h"
#include "core/programs/supervisor_process.h"
#include "fuzz/files.h"
#include "fuzz/hunt/round_bytes.h"
#include "oracle/truth.h"
#include "subjects/subjects.h"

#ifdef GRAZE_LIBFUZZER
extern "C" int LLVMFuzzerRunDriver(int* count, char*** arguments, int (*one)(const std::uint8_t*, std::size_t));

// libFuzzer finds these counters by their section's name. A pair is interesting if it sets a counter that no earlier
// pair set.
__attribute__((used, section("__libfuzzer_extra_counters"))) static std::uint8_t extra_counters[graze::fuzz::kFeatures];
#else
static std::uint8_t extra_counters[graze::fuzz::kFeatures];
#endif

namespace graze::fuzz {
namespace {

constexpr std::uint32_t kMutations = 0x301;  // takes the place of a stratum's number in draws

// Ends this process without running exit handlers, because it is a copy of a process that continues.
[[noreturn]] void leave(int status) { _exit(status); }

// Closes all descriptors except the standard streams and the files of foreign code and of the programs that run foreign
// code. An open descriptor would keep the folder locked after the parent process has ended.
void close_all_but_code(const SelectedLanes& under_test) {
  std::vector<int> kept(program_files().begin(), program_files().end());
  for (const Lane* lane : under_test.lanes) {
    if (lane->foreign) kept.push_back(subjects::processes_of(*lane).content());
  }
  std::sort(kept.begin(), kept.end());
  int first = 3;
  for (const int fd : kept) {
    if (fd > first) close_range(static_cast<unsigned>(first), static_cast<unsigned>(fd) - 1, 0);
    first = std::max(first, fd + 1);
  }
  close_range(static_cast<unsigned>(first), ~0u, 0);
}

class Round {
 public:
  Round(const RoundTask& task, std::filesystem::path file)
      : task_(task),
        file_(std::move(file)),
        counts_(no_counts(*task.campaign)),
        feedback_(task.campaign->under_test->lanes) {
    // The foreign code's processes belong to the parent and answer only the parent, so new ones are started.
    under_test_.lanes = task.campaign->under_test->lanes;
    for (std::size_t l = 0; l < under_test_.lanes.size(); ++l) {
      under_test_.on_host.push_back(task.campaign->under_test->on_host[l]);
      if (!under_test_.lanes[l]->foreign) continue;
      foreign_.push_back(subjects::processes_of(*under_test_.lanes[l]).anew());
      under_test_.on_host.back() = DecideBlock(*foreign_.back());
    }
    campaign_.seed = task.campaign->seed;
    campaign_.sources = {{task.campaign->sources[0].id, task.campaign->sources[0].pairs, nullptr}};
    campaign_.under_test = &under_test_;
    judge_.emplace(campaign_);
    pairs_.reserve(task.range.pairs);
    for (const Unit& unit : *task.corpus) {
      for (const std::uint16_t f : unit.features) seen_.set(f);
    }
  }

  // Writes libFuzzer's next input and returns its size: first the corpus's units, then mutations of kept pairs.
  std::size_t next(std::uint8_t* data, std::size_t size, const std::uint8_t* other_data, std::uint32_t seed) {
    given_ = nullptr;
    const auto put = [data](const auto& pair) {
      std::memcpy(data, &pair, sizeof pair);
      return sizeof pair;
    };
    if (next_unit_ < task_.corpus->size()) {
      given_ = &(*task_.corpus)[next_unit_++];
      return visit(given_->pair, put);
    }
    const auto draw = [&](auto draws) {
      DrawnPair<decltype(draws)> pair, other;
      if (size == sizeof pair) std::memcpy(&pair, data, sizeof pair);
      if (other_data) std::memcpy(&other, other_data, sizeof other);
      mutation_ = Mutation::fresh;
      return put(size == sizeof pair ? next_pair(*task_.drawn, pair, other_data ? &other : nullptr, draws, mutation_)
                                     : fresh_pair(*task_.drawn, draws));
    };
    const std::uint64_t turn = turn_++;
    return task_.drawn->in_doubles() ? draw(strata::DoubleDraws(seed, kMutations, turn))
                                     : draw(strata::Draws(seed, kMutations, turn));
  }

  std::size_t pair_size() const { return task_.drawn->in_doubles() ? sizeof(DoublePair) : sizeof(Pair); }
  bool has_units_left() const { return next_unit_ < task_.corpus->size(); }

  void one(const std::uint8_t* data, std::size_t size) {
    const std::optional<AnyPair> pair = pair_from(data, size);
    if (!pair) {  // libFuzzer's initial input
      extra_counters[0] = 1;
      return;
    }
    if (given_) {
      for (const std::uint16_t f : given_->features) extra_counters[f] = 1;
      return;
    }
    if (pairs_.size() == task_.range.pairs) finish();
    const std::uint64_t index = task_.range.first + pairs_.size();
    const PairJudge::Found& found = judge_->judge(*pair, index, counts_);
    Unit unit{*pair, feedback_.features(*pair, found)};
    MutationCounts& counts = mutations_[static_cast<std::size_t>(mutation_)];
    ++counts.pairs;
    counts.disagreements += !found.failures.empty();
    for (const std::uint16_t f : unit.features) extra_counters[f] = 1;
    std::erase_if(unit.features, [&](std::uint16_t f) { return seen_.test(f); });
    if (!unit.features.empty()) {
      for (const std::uint16_t f : unit.features) seen_.set(f);
      ++counts.units;
      units_.push_back(std::move(unit));
    }
    pairs_.push_back({*pair, mutation_});
  }

  // The process ends here even if writing the error fails.
  [[noreturn]] void fail(const char* what, bool apart) {
    try {
      write_whole(file_, error_bytes(what, apart));
    } catch (...) {
    }
    leave(3);
  }

 private:
  [[noreturn]] void finish() {
    RoundResult result(static_cast<int>(under_test_.lanes.size()));
    result.counts = StoredCounts(counts_);
    result.units = std::move(units_);
    result.mutations = mutations_;
    for (const auto& [key, found] : result.counts.signatures) {
      for (const CaseKey& c : found.cases) result.kept.emplace(c.index, pairs_[c.index - task_.range.first]);
    }
    write_whole(file_, result_bytes(result));
    foreign_.clear();
    leave(0);
  }

  RoundTask task_;
  std::filesystem::path file_;
  SelectedLanes under_test_;
  std::vector<std::unique_ptr<subjects::ForeignProcesses>> foreign_;
  Campaign campaign_;
  std::optional<PairJudge> judge_;
  BatchResult counts_;
  Feedback feedback_;
  std::bitset<kFeatures> seen_;
  std::vector<FoundPair> pairs_;
  std::vector<Unit> units_;
  std::array<MutationCounts, kMutationCount> mutations_{};
  std::size_t next_unit_ = 0;
  const Unit* given_ = nullptr;  // the next input if it is a corpus unit
  Mutation mutation_ = Mutation::fresh;
  std::uint64_t turn_ = 0;
};

Round* current = nullptr;  // a global variable, because libFuzzer's callbacks have no context

// An exception must not pass through libFuzzer, which is built without exceptions.
template <class Act>
auto guarded(Act act) {
  try {
    return act();
  } catch (const oracle::OracleMismatch& error) {
    current->fail(error.what(), true);
  } catch (const std::exception& error) {
    current->fail(error.what(), false);
  }
}

}  // namespace

#ifdef GRAZE_LIBFUZZER

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t, unsigned seed) {
  return guarded([&] { return current->next(data, size, nullptr, seed); });
}

// Skips most crossings by returning 0, so that crossings are one mutation in fourteen, like every other kind.
extern "C" std::size_t LLVMFuzzerCustomCrossOver(const std::uint8_t* data, std::size_t size, const std::uint8_t* other,
                                                 std::size_t other_size, std::uint8_t* out, std::size_t,
                                                 unsigned seed) {
  if (current->has_units_left() || size != current->pair_size() || other_size != size ||
      seed % (kMutationCount - 1) != 0)
    return 0;
  std::memcpy(out, data, size);
  return guarded([&] { return current->next(out, size, other, seed); });
}

bool has_libfuzzer() { return true; }

pid_t start_round(const RoundTask& task, const std::filesystem::path& file) {
  const pid_t parent = getpid(), child = fork();
  if (child < 0)
    throw std::runtime_error(fmt::format("cannot start the process of a hunt's round: {}", std::strerror(errno)));
  if (child > 0) return child;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) leave(1);
  close_all_but_code(*task.campaign->under_test);
  const int nowhere = open("/dev/null", O_RDWR);
  for (const int stream : {0, 1, 2}) dup2(nowhere, stream);
  for (const int number : {SIGINT, SIGTERM}) std::signal(number, SIG_IGN);  // the parent ends this process
  Round round(task, file);
  current = &round;
  // The seed is never 0, because libFuzzer would use the time of day instead.
  const std::uint64_t seed = fnv1a(fmt::format("{} {}", task.campaign->seed, task.range.first)) % 0xffffffffu + 1;
  const std::string length = fmt::format("-max_len={}", round.pair_size()), seeded = fmt::format("-seed={}", seed);
  // The entropic schedule is off: with a hundred features per pair, it would cost more than the lanes and the oracle.
  std::vector<const char*> words{"graze",
                                 length.c_str(),
                                 seeded.c_str(),
                                 "-runs=-1",
                                 "-len_control=0",
                                 "-timeout=0",
                                 "-rss_limit_mb=0",
                                 "-malloc_limit_mb=0",
                                 "-detect_leaks=0",
                                 "-reload=0",
                                 "-verbosity=0",
                                 "-print_final_stats=0",
                                 "-entropic=0",
                                 "-handle_segv=0",
                                 "-handle_bus=0",
                                 "-handle_abrt=0",
                                 "-handle_ill=0",
                                 "-handle_fpe=0",
                                 "-handle_int=0",
                                 "-handle_term=0",
                                 "-handle_xfsz=0",
                                 "-handle_usr1=0",
                                 "-handle_usr2=0",
                                 "-purge_allocator_interval=-1",
                                 nullptr};
  int count = static_cast<int>(words.size()) - 1;
  char** arguments = const_cast<char**>(words.data());
  LLVMFuzzerRunDriver(&count, &arguments, [](const std::uint8_t* data, std::size_t size) {
    guarded([&] {
      current->one(data, size);
      return 0;
    });
    return 0;
  });
  leave(4);
}

#else

bool has_libfuzzer() { return false; }
pid_t start_round(const RoundTask&, const std::filesystem::path&) { throw std::logic_error("no libFuzzer"); }

#endif

RoundResult round_result(const RoundTask& task, const std::filesystem::path& file) {
  const std::string bytes = read_whole(file);
  if (bytes.empty()) throw std::runtime_error(cannot("read", file, "the process of this round ended without a result"));
  return parse_result(bytes, task);
}

}  // namespace graze::fuzz
