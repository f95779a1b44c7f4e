// SPDX-License-Identifier: Apache-2.0
#include "fuzz/hunt/hunt.h"

#include <fmt/format.h>
#include <sys/wait.h>
#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bitset>
#include <chrono>
#include <csignal>
#include <deque>
#include <set>

#include "core/fnv1a.h"
#include "fuzz/campaign/result_files.h"
#include "fuzz/hunt/round.h"
#include "fuzz/hunt/round_bytes.h"
#include "fuzz/minimise/kinds.h"

namespace graze::fuzz {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

// Processes of rounds; those that still run when it ends are ended.
class Processes {
 public:
  ~Processes() {
    for (const auto& [pid, place] : running_) {
      kill(pid, SIGKILL);
      waitpid(pid, nullptr, 0);
    }
  }
  std::size_t size() const { return running_.size(); }
  void add(pid_t pid) { running_.emplace(pid, 0); }
  // Waits a little.   Returns: whether one of them has ended.
  bool wait_for_one() {
    for (auto it = running_.begin(); it != running_.end(); ++it) {
      if (waitpid(it->first, nullptr, WNOHANG) == 0) continue;
      running_.erase(it);
      return true;
    }
    const timespec pause{0, 2'000'000};
    nanosleep(&pause, nullptr);
    return false;
  }

 private:
  std::map<pid_t, int> running_;
};

class Hunter {
 public:
  Hunter(Hunt& hunt, const std::atomic<bool>& stop, const std::function<void(const HuntProgress&)>& report)
      : hunt_(hunt), stop_(stop), report_(report), kept_(std::make_shared<std::map<std::uint64_t, FoundPair>>()),
        per_round_(round_pairs(hunt.pairs)) {
    hunt.campaign.sources = {
        {"hunt", hunt.pairs, [kept = kept_](std::uint64_t index) { return kept->at(index).pair; }}};
    threads_ = hunt.campaign.threads > 0 ? hunt.campaign.threads : tbb::info::default_concurrency();
    store_.emplace(store_spec(hunt.campaign));
    checksum_ = fnv1a(hunt.campaign.spec.dump() + hunt.campaign.build.dump());
    fs::create_directories(folder());
    for (const auto& file : fs::directory_iterator(folder())) {  // of processes that were killed
      if (file.path().extension() != ".round") fs::remove(file.path());
    }
  }

  Outcome run() {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads_));
    const std::uint64_t rounds = (hunt_.pairs + per_round_ - 1) / per_round_;
    for (std::uint64_t first = 0; first < rounds && !over(); first += kRoundsOfGeneration)
      generation(first, std::min(rounds, first + kRoundsOfGeneration));
    const bool complete = store_->done(0) == hunt_.pairs;
    Outcome outcome{complete, write_summary(hunt_.campaign, *store_, complete), store_->oracle()};
    write_whole(hunt_.campaign.directory / "hunt.json", told().dump(1) + "\n");
    append_timing(hunt_.campaign.directory,
                  {{"pairs", done_here_}, {"seconds", seconds()}, {"threads", threads_}, {"machine", machine_name()}, {"engine", "cpu"}},
                  outcome.oracle);
    return outcome;
  }

 private:
  struct Wanted {
    PairRange range;
    std::optional<KeptRound> kept;
    bool committed = false;
    bool whole() const { return kept && committed; }
  };

  fs::path folder() const { return hunt_.campaign.directory / "hunt"; }
  fs::path file_of(const PairRange& range, const char* kind) const {
    return folder() / fmt::format("{:06}.{}", range.first / per_round_, kind);
  }
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  bool over() const { return stop_ || (hunt_.seconds > 0 && seconds() >= hunt_.seconds); }

  // Rounds [first, last), all from the corpus as it is now; then what they found, in their order.
  void generation(std::uint64_t first, std::uint64_t last) {
    std::vector<Wanted> rounds;
    for (std::uint64_t r = first; r < last; ++r) {
      Wanted wanted;
      wanted.range = {0, r * per_round_, std::min(per_round_, hunt_.pairs - r * per_round_)};
      wanted.kept = parse_round(read_whole(file_of(wanted.range, "round")), checksum_);
      wanted.committed = store_->holds(wanted.range);
      rounds.push_back(std::move(wanted));
    }
    if (!play(rounds)) return;
    for (Wanted& round : rounds) {
      if (!round.whole()) finish(round);
      take(*round.kept);
      report_progress();
    }
  }

  // Runs those that are not whole, as many at once as there are threads.   Returns: whether all came to their end.
  bool play(const std::vector<Wanted>& rounds) {
    Processes processes;
    for (const Wanted& round : rounds) {
      if (round.whole()) continue;
      while (processes.size() >= static_cast<std::size_t>(threads_)) {
        if (over()) return false;
        processes.wait_for_one();
      }
      const fs::path file = file_of(round.range, "result");
      fs::remove(file);
      processes.add(start_round(task_of(round), file));
    }
    while (processes.size() > 0) {
      if (over()) return false;
      processes.wait_for_one();
    }
    return true;
  }

  RoundTask task_of(const Wanted& round) const { return {&hunt_.campaign, &hunt_.drawn, round.range, &corpus_}; }

  // Keeps the round, and what is new in it.
  void finish(Wanted& round) {
    const fs::path result_file = file_of(round.range, "result");
    RoundResult result = round_result(task_of(round), result_file);
    KeptRound kept{round.range.first, round.range.pairs, {}, {}, result.mutations, {}, {}};
    std::bitset<kFeatures> seen = seen_;
    for (Unit& unit : result.units) {
      std::erase_if(unit.features, [&](std::uint16_t f) { return seen.test(f); });
      if (unit.features.empty()) continue;
      for (const std::uint16_t f : unit.features) seen.set(f);
      kept.units.push_back(std::move(unit));
    }
    for (const auto& [key, found] : result.counts.signatures) {
      SignatureCount all = found;
      const auto before = store_->signatures().find(key);
      if (!round.committed && before != store_->signatures().end()) all.add(before->second);
      for (const CaseKey& c : all.cases) {
        const auto own = result.kept.find(c.index);
        if (own != result.kept.end()) kept.kept.insert(*own);
      }
    }
    find_kinds_of(result, kept);
    write_whole(file_of(round.range, "round"), round_bytes(kept, checksum_));
    if (!round.committed) {
      store_->commit(round.range, result.counts);
      done_here_ += round.range.pairs;
    }
    round.committed = true;
    round.kept = std::move(kept);
    fs::remove(result_file);
  }

  // One pair tells of all that are wrong in the same way, at whatever margin.
  void find_kinds_of(const RoundResult& result, KeptRound& kept) const {
    struct New {
      analysis::Signature signature;
      std::uint64_t index;
      std::vector<LaneReason> reasons;
    };
    std::vector<New> fresh;
    std::set<std::string> coarse = coarse_;
    for (const auto& [key, found] : result.counts.signatures) {
      const std::optional<analysis::Signature> signature = analysis::parse_signature(key);
      if (!signature || !coarse.insert(coarse_key(*signature)).second) continue;
      kept.coarse.push_back(coarse_key(*signature));
      fresh.push_back({*signature, found.cases.front().index, {}});
    }
    tbb::parallel_for(std::size_t{0}, fresh.size(), [&](std::size_t i) {
      const Verdict truth = fresh[i].signature.contact == Contact::none ? Verdict::disjoint : Verdict::intersects;
      fresh[i].reasons = reasons_of(*hunt_.campaign.under_test, fresh[i].signature.subject, result.kept.at(fresh[i].index).pair, truth);
    });
    std::sort(fresh.begin(), fresh.end(), [](const New& l, const New& r) { return l.index < r.index; });
    std::set<std::string> known = kinds_;
    for (const New& of : fresh) {
      for (const LaneReason& reason : of.reasons) {
        const std::string key = kind_key(of.signature.subject, reason, of.signature.shape);
        if (known.insert(key).second) kept.kinds.push_back({key, of.index, result.kept.at(of.index).mutation});
      }
    }
  }

  void take(const KeptRound& round) {
    for (const Unit& unit : round.units) {
      corpus_.push_back(unit);
      for (const std::uint16_t f : unit.features) seen_.set(f);
    }
    kept_->insert(round.kept.begin(), round.kept.end());
    coarse_.insert(round.coarse.begin(), round.coarse.end());
    for (std::size_t m = 0; m < mutations_.size(); ++m) {
      mutations_[m].pairs += round.mutations[m].pairs;
      mutations_[m].disagreements += round.mutations[m].disagreements;
      mutations_[m].units += round.mutations[m].units;
    }
    for (const NewKind& kind : round.kinds) {
      kinds_.insert(kind.key);
      in_order_.push_back(kind);
    }
    done_ = round.first + round.pairs;
    if (done_here_ == 0) known_before_ = kinds_.size();
    if (!round.kinds.empty() && done_here_ > 0) last_kind_ = seconds();
  }

  void report_progress() const {
    report_({done_, hunt_.pairs, done_here_, seconds(), corpus_.size(), store_->signatures().size(), kinds_.size(),
             kinds_.size() - known_before_, seconds() - last_kind_});
  }

  // {"pairs", "units", "mutations": [{"mutation", "pairs", "disagreements", "units", "kinds"}],
  //  "kinds": [{"key", "index", "mutation"}]}, kinds in the order in which they were found.
  Json told() const {
    Json mutations = Json::array(), kinds = Json::array();
    std::array<std::uint64_t, kMutationCount> kinds_of{};
    for (const NewKind& kind : in_order_) {
      ++kinds_of[static_cast<std::size_t>(kind.mutation)];
      kinds.push_back({{"key", kind.key}, {"index", kind.index}, {"mutation", kMutationIds[static_cast<std::size_t>(kind.mutation)]}});
    }
    for (std::size_t m = 0; m < mutations_.size(); ++m) {
      mutations.push_back({{"mutation", kMutationIds[m]},
                           {"pairs", mutations_[m].pairs},
                           {"disagreements", mutations_[m].disagreements},
                           {"units", mutations_[m].units},
                           {"kinds", kinds_of[m]}});
    }
    return {{"pairs", done_}, {"units", corpus_.size()}, {"mutations", mutations}, {"kinds", kinds}};
  }

  Hunt& hunt_;
  const std::atomic<bool>& stop_;
  const std::function<void(const HuntProgress&)>& report_;
  std::shared_ptr<std::map<std::uint64_t, FoundPair>> kept_;
  std::uint64_t per_round_, checksum_ = 0, done_ = 0, done_here_ = 0;
  int threads_;
  std::optional<Store> store_;
  std::vector<Unit> corpus_;
  std::bitset<kFeatures> seen_;
  std::set<std::string> coarse_, kinds_;
  std::vector<NewKind> in_order_;
  std::array<MutationCounts, kMutationCount> mutations_{};
  std::size_t known_before_ = 0;
  double last_kind_ = 0;
  const Clock::time_point start_ = Clock::now();
};

}  // namespace

std::uint64_t round_pairs(std::uint64_t pairs) { return std::clamp(pairs / 32, std::uint64_t{256}, std::uint64_t{32768}); }

Json hunt_spec(const Hunt& hunt) {
  Json spec = {{"seed", hunt.campaign.seed}, {"pairs", hunt.pairs}, {"strata", {"hunt"}}, {"lanes", Json::array()}};
  for (const Lane* lane : hunt.campaign.under_test->lanes) spec["lanes"].push_back(lane->id);
  for (const strata::PairSource& source : hunt.drawn.sources) spec["hunt"]["strata"].push_back(source.id);
  return spec;
}

Outcome run_hunt(Hunt& hunt, const std::atomic<bool>& stop, const std::function<void(const HuntProgress&)>& report) {
  return Hunter(hunt, stop, report).run();
}

}  // namespace graze::fuzz
