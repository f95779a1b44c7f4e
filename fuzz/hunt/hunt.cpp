// SPDX-License-Identifier: Apache-2.0
#include "fuzz/hunt/hunt.h"

#include <sys/wait.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <bitset>
#include <chrono>
#include <csignal>
#include <set>

#include "analysis/over_threads.h"
#include "core/cannot.h"
#include "core/error.h"
#include "fuzz/campaign/result_files.h"
#include "fuzz/campaign/run_status.h"
#include "fuzz/hunt/hunt_rounds.h"
#include "fuzz/hunt/round.h"
#include "fuzz/hunt/round_bytes.h"
#include "fuzz/minimise/kinds.h"
#include "fuzz/own_files.h"

namespace graze::fuzz {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

// The rounds' processes; the destructor kills those that are still running.
class Processes {
 public:
  ~Processes() {
    for (const pid_t pid : running_) {
      kill(pid, SIGKILL);
      waitpid(pid, nullptr, 0);
    }
  }
  std::size_t size() const { return running_.size(); }
  void add(pid_t pid) { running_.push_back(pid); }
  // Removes processes that have ended; if none has, waits for 2 ms.
  void wait_for_one() {
    if (std::erase_if(running_, [](pid_t pid) { return waitpid(pid, nullptr, WNOHANG) != 0; }) > 0) return;
    const timespec pause{0, 2'000'000};
    nanosleep(&pause, nullptr);
  }

 private:
  std::vector<pid_t> running_;
};

// Whether a killed process left this file: a round's unread result, such as "000012.result", or a partial file.
bool is_of_killed_round(const fs::directory_entry& file) {
  const std::string name = file.path().filename().string();
  const std::size_t digits = name.find_first_not_of("0123456789");
  const std::string rest = digits >= 6 && digits != name.npos ? name.substr(digits) : "";
  return file.symlink_status().type() == fs::file_type::regular &&
         ((rest == ".result" && are_of_result(read_whole(file.path()))) || rest == std::string(".result") + kPart ||
          rest == std::string(".round") + kPart);
}

class Hunter {
 public:
  Hunter(Hunt& hunt, const std::atomic<bool>& stop, const std::function<void(const HuntProgress&)>& report)
      : hunt_(hunt),
        stop_(stop),
        report_(report),
        found_(std::make_shared<HuntRounds>()),
        status_(hunt.campaign),
        share_(share_of(hunt.campaign.shard, 0, hunt.pairs)),
        per_round_(round_pairs(share_.pairs)) {
    hunt.campaign.sources = {source_of_hunt(hunt.pairs, hunt.drawn.in_doubles(), found_)};
    threads_ = hunt.campaign.threads > 0 ? hunt.campaign.threads : tbb::info::default_concurrency();
    store_.emplace(store_spec(hunt.campaign));
    if (fs::exists(merged_rounds_file(hunt.campaign.directory)))
      throw UsageError(cannot("resume", hunt.campaign.directory,
                              "it is a finished hunt that was merged from shards; choose another --out"));
    expect_usable_records(hunt.campaign.directory);
    checksum_ = hunt_checksum(hunt.campaign.spec, hunt.campaign.build);
    fs::create_directories(folder());
    for (const auto& file : fs::directory_iterator(folder())) {
      if (is_of_killed_round(file)) fs::remove(file.path());
    }
  }

  Outcome run() {
    try {
      const tbb::global_control limit = analysis::thread_limit(threads_);
      tell_status();
      const std::uint64_t rounds = (share_.pairs + per_round_ - 1) / per_round_;
      for (std::uint64_t first = 0; first < rounds; first += kRoundsOfGeneration) {
        if (!generation(first, std::min(rounds, first + kRoundsOfGeneration))) break;
      }
      Outcome outcome = finished();
      store_.reset();
      status_.end(outcome.complete ? "done" : "stopped");
      if (outcome.complete) seal(hunt_.campaign.directory);
      return outcome;
    } catch (const MovedStore&) {  // the folder's status file may belong to another run
      throw;
    } catch (const std::exception& error) {
      status_.end("failed", error.what());
      throw;
    }
  }

 private:
  struct Wanted {
    PairRange range;
    std::optional<KeptRound> kept;
    bool committed = false;
    bool whole() const { return kept && committed; }
  };

  fs::path folder() const { return rounds_folder(hunt_.campaign.directory); }
  fs::path file_of(const PairRange& range) const { return round_file(hunt_.campaign.directory, share_, range.first); }
  fs::path result_file_of(const PairRange& range) const { return file_of(range).replace_extension(".result"); }
  double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  bool over() const { return stop_ || (hunt_.seconds > 0 && seconds() >= hunt_.seconds); }

  // Runs the rounds [first, last), all from the current corpus, then adds their findings in order. Rounds that are done
  // are added even after a stop.   Returns: whether all of them are done.
  bool generation(std::uint64_t first, std::uint64_t last) {
    std::vector<Wanted> rounds;
    for (std::uint64_t r = first; r < last; ++r) {
      Wanted wanted;
      wanted.range = {0, share_.first + r * per_round_, std::min(per_round_, share_.pairs - r * per_round_)};
      wanted.kept = parse_round(read_whole(file_of(wanted.range)), checksum_);
      if (wanted.kept && (wanted.kept->first != wanted.range.first || wanted.kept->pairs != wanted.range.pairs))
        wanted.kept.reset();  // the file belongs to another round
      wanted.committed = store_->holds(wanted.range);
      rounds.push_back(std::move(wanted));
    }
    if (!play(rounds)) return false;
    for (Wanted& round : rounds) {
      if (!round.whole()) finish(round);
      take(*round.kept);
      report_progress();
    }
    return true;
  }

  // Runs the rounds that are not done yet, at most `threads_` at once.   Returns: whether all rounds are done.
  bool play(const std::vector<Wanted>& rounds) {
    Processes processes;
    for (const Wanted& round : rounds) {
      if (round.whole()) continue;
      while (!over() && processes.size() >= static_cast<std::size_t>(threads_)) processes.wait_for_one();
      if (over()) return false;
      const fs::path file = result_file_of(round.range);
      if (fs::is_regular_file(fs::symlink_status(file)) && !may_replace_foreign && !are_of_result(read_whole(file)))
        throw UsageError(cannot("replace", file, kForeign));
      fs::remove(file);
      processes.add(start_round(task_of(round), file));
    }
    while (processes.size() > 0) {
      if (over()) return false;
      processes.wait_for_one();
    }
    return true;
  }

  RoundTask task_of(const Wanted& round) const {
    return {&hunt_.campaign, &hunt_.drawn, round.range, &found_->all.units};
  }

  // Stores the round and its new findings.
  void finish(Wanted& round) {
    const fs::path result_file = result_file_of(round.range);
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
      for (const CaseKey& c : found.cases) {
        const auto own = result.kept.find(c.index);
        if (own != result.kept.end()) kept.kept.insert(*own);
      }
    }
    find_kinds_of(result, kept);
    write_whole(file_of(round.range), round_bytes(kept, checksum_));
    if (!round.committed) {
      store_->commit(round.range, result.counts);
      done_here_ += round.range.pairs;
    }
    round.committed = true;
    round.kept = std::move(kept);
    fs::remove(result_file);
  }

  // Examines one pair for each signature that is new when margins are ignored.
  void find_kinds_of(const RoundResult& result, KeptRound& kept) const {
    struct New {
      analysis::Signature signature;
      std::uint64_t index;
      std::vector<LaneReason> reasons;
    };
    std::vector<New> fresh;
    std::set<std::string> coarse = found_->coarse;
    for (const auto& [key, found] : result.counts.signatures) {
      const std::optional<analysis::Signature> signature = analysis::parse_signature(key);
      if (!signature || !coarse.insert(analysis::coarse_key(*signature)).second) continue;
      kept.coarse.push_back(analysis::coarse_key(*signature));
      fresh.push_back({*signature, found.cases.front().index, {}});
    }
    tbb::parallel_for(std::size_t{0}, fresh.size(), [&](std::size_t i) {
      const Verdict truth = fresh[i].signature.contact == Contact::none ? Verdict::disjoint : Verdict::intersects;
      fresh[i].reasons = reasons_of(*hunt_.campaign.under_test, fresh[i].signature.subject,
                                    result.kept.at(fresh[i].index).pair, truth);
    });
    std::sort(fresh.begin(), fresh.end(), [](const New& l, const New& r) { return l.index < r.index; });
    std::set<std::string> known = found_->kinds;
    for (const New& of : fresh) {
      for (const LaneReason& reason : of.reasons) {
        const std::string key = kind_key(of.signature.subject, reason, shape_name(of.signature));
        if (known.insert(key).second) kept.kinds.push_back({key, of.index, result.kept.at(of.index).mutation});
      }
    }
  }

  void take(const KeptRound& round) {
    for (const Unit& unit : round.units) {
      for (const std::uint16_t f : unit.features) seen_.set(f);
    }
    found_->add(round);
    if (done_here_ == 0) known_before_ = found_->kinds.size();
    if (!round.kinds.empty() && done_here_ > 0) last_kind_ = seconds();
  }

  void report_progress() {
    tell_status();
    report_({found_->all.pairs, share_.pairs, done_here_, seconds(), found_->all.units.size(),
             store_->signatures().size(), found_->kinds.size(), found_->kinds.size() - known_before_,
             seconds() - last_kind_});
  }

  void tell_status(bool last = false) {
    Progress progress;
    progress.done = found_->all.pairs;
    progress.total = share_.pairs;
    progress.done_here = done_here_;
    progress.seconds = seconds();
    if (done_here_ > 0)
      progress.seconds_left =
          progress.seconds / static_cast<double>(done_here_) * static_cast<double>(progress.total - progress.done);
    progress.all_disagreements = store_->disagreements();
    progress.signatures = store_->signatures().size();
    status_.tell(progress, store_->signatures(), last);
  }

  Outcome finished() {
    const bool complete = store_->gaps(0).empty() && found_->all.pairs == share_.pairs;
    if (!complete) tell_status(true);
    Outcome outcome{complete, write_own_summary(hunt_.campaign, *store_, complete, found_->all.pairs),
                    store_->oracle()};
    write_whole(hunt_.campaign.directory / "hunt.json", found_->told().dump(1) + "\n");
    append_timing(hunt_.campaign.directory,
                  {{"pairs", done_here_},
                   {"seconds", seconds()},
                   {"threads", threads_},
                   {"machine", machine_name()},
                   {"engine", "cpu"}},
                  outcome.oracle);
    return outcome;
  }

  Hunt& hunt_;
  const std::atomic<bool>& stop_;
  const std::function<void(const HuntProgress&)>& report_;
  std::shared_ptr<HuntRounds> found_;  // the finished rounds, in order
  RunStatus status_;
  PairRange share_;
  std::uint64_t per_round_, checksum_ = 0, done_here_ = 0;
  int threads_;
  std::optional<Store> store_;
  std::bitset<kFeatures> seen_;
  std::size_t known_before_ = 0;
  double last_kind_ = 0;
  const Clock::time_point start_ = Clock::now();
};

}  // namespace

Json hunt_spec(const Hunt& hunt) {
  const std::string id = source_of_hunt(hunt.pairs, hunt.drawn.in_doubles(), nullptr).id;
  Json spec = {{"seed", hunt.campaign.seed}, {"pairs", hunt.pairs}, {"strata", {id}}, {"lanes", Json::array()}};
  for (const Lane* lane : hunt.campaign.under_test->lanes) spec["lanes"].push_back(lane->id);
  for (const strata::PairSource& source : hunt.drawn.sources) spec["hunt"]["strata"].push_back(source.id);
  add_left_out(spec, *hunt.campaign.under_test);
  return spec;
}

Outcome run_hunt(Hunt& hunt, const std::atomic<bool>& stop, const std::function<void(const HuntProgress&)>& report) {
  return Hunter(hunt, stop, report).run();
}

}  // namespace graze::fuzz
