// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/run_status.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <fstream>
#include <set>

#include "core/cannot.h"
#include "core/error.h"
#include "core/fnv1a.h"
#include "core/text.h"
#include "fuzz/files.h"
#include "fuzz/own_files.h"
#include "fuzz/sealed.h"

namespace graze::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFile = "status.json";
constexpr double kSecondsBetween = 2;

std::int64_t now() {
  return std::chrono::duration_cast<std::chrono::seconds>(std::chrono::system_clock::now().time_since_epoch()).count();
}

// The distinct hashes of the signatures, ignoring margins.
std::set<std::string> ways_of(const std::map<std::string, SignatureCount>& signatures) {
  std::set<std::string> ways;
  for (const auto& [key, count] : signatures) {
    if (const auto signature = analysis::parse_signature(key))
      ways.insert(fmt::format("{:016x}", fnv1a(analysis::coarse_key(*signature))));
  }
  return ways;
}

// Throws: std::runtime_error that describes the error; Json::exception if keys or types are wrong.
void expect_possible_status(const Json& status) {
  const std::string state = status.at("state"), shard = status.at("shard");
  if (state != "running" && state != "done" && state != "stopped" && state != "failed")
    throw std::runtime_error("its state is not running, done, stopped or failed, but " + shown(state));
  if (!parse_shard(shard)) throw std::runtime_error("its shard is not K/N, but " + shown(shard));
  for (const char* count : {"pairs", "done", "disagreements", "signatures"})
    status.at(count).get_ref<const Json::number_unsigned_t&>();
  const std::uint64_t pairs = status["pairs"], done = status["done"], disagreements = status["disagreements"];
  if (done > pairs || disagreements > done || (state == "done" && done != pairs))
    throw std::runtime_error(fmt::format("its counts contradict each other: {}, {} pairs, {} done, {} disagreements",
                                         state, pairs, done, disagreements));
  const Json& left = status.at("seconds_left");
  if (status.at("rate").get<double>() < 0 || (!left.is_null() && left.get<double>() < 0))
    throw std::runtime_error(
        fmt::format("its rate or its remaining time is below 0: {}, {}", status["rate"].dump(), left.dump()));
  const std::vector<std::string> all_ways = status.at("ways");
  const std::set<std::string> ways(all_ways.begin(), all_ways.end());
  if (ways.size() < all_ways.size()) throw std::runtime_error("one of its ways occurs twice");
  if (!std::all_of(ways.begin(), ways.end(), is_hash)) throw std::runtime_error("one of its ways is not a hash");
  const std::uint64_t signatures = status["signatures"];
  if (ways.size() > signatures || (signatures > 0 && (disagreements == 0 || ways.empty())))
    throw std::runtime_error(fmt::format("its counts contradict each other: {} disagreements, {} signatures, {} ways",
                                         disagreements, signatures, ways.size()));
  for (const char* whole : {"process", "updated"}) {
    if (!status.at(whole).is_number_unsigned())
      throw std::runtime_error(fmt::format("{} is not a count, but {}", whole, shown(status[whole].dump())));
  }
  status.at("host").get_ref<const std::string&>();
  if (status.contains("why")) status["why"].get_ref<const std::string&>();
  if (status.contains("hash") && !is_hash(status["hash"].get_ref<const std::string&>()))
    throw std::runtime_error("its hash is not 16 hexadecimal digits");
}

}  // namespace

RunStatus::RunStatus(const Campaign& campaign) : file_(campaign.directory / kFile) {
  char host[256] = {};
  gethostname(host, sizeof host - 1);
  status_ = {{"state", "running"},
             {"shard", campaign.shard.name()},
             {"pairs", 0},
             {"done", 0},
             {"rate", 0},
             {"seconds_left", nullptr},
             {"disagreements", 0},
             {"signatures", 0},
             {"ways", Json::array()},
             {"host", host},
             {"process", getpid()},
             {"updated", now()}};
}

void RunStatus::write() {
  status_["updated"] = now();
  try {
    write_whole(file_, sealed(status_).dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
  } catch (const std::runtime_error&) {
  }
}

void RunStatus::tell(const Progress& progress, const std::map<std::string, SignatureCount>& signatures, bool last) {
  status_["pairs"] = progress.total;
  status_["done"] = progress.done;
  status_["rate"] = progress.seconds > 0 ? static_cast<double>(progress.done_here) / progress.seconds : 0;
  // The estimate does not include the time after the last pair, when the run measures costs and writes its results.
  status_["seconds_left"] =
      progress.seconds_left && progress.done < progress.total ? Json(*progress.seconds_left) : Json();
  status_["disagreements"] = progress.all_disagreements;
  last = last || progress.done == progress.total;
  if (written_ >= 0 && progress.seconds - written_ < kSecondsBetween && !last) return;
  written_ = progress.seconds;
  status_["signatures"] = signatures.size();  // written together with the ways
  status_["ways"] = ways_of(signatures);
  write();
}

void RunStatus::end(const std::string& state, const std::string& why) {
  if (written_ < 0) return;
  status_["state"] = state;
  if (!why.empty()) status_["why"] = why;
  write();
}

std::string file_hash(const fs::path& file) {
  expect_file(file);
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  std::uint64_t hash = fnv1a("");
  std::string bytes(1 << 20, '\0');
  while (in.read(bytes.data(), static_cast<std::streamsize>(bytes.size())), in.gcount() > 0)
    hash = fnv1a({bytes.data(), static_cast<std::size_t>(in.gcount())}, hash);
  if (in.bad() || !in.eof()) throw std::runtime_error(cannot("read", file, errno != 0 ? errno : EIO));
  return fmt::format("{:016x}", hash);
}

void seal(const fs::path& directory) {
  Json status;
  try {
    status = read_status(directory);
  } catch (const std::runtime_error&) {  // the status was changed after the run wrote it; the run is done anyway
  }
  if (status.is_null()) return;
  status["hash"] = file_hash(directory / kDatabase);
  write_whole(directory / kFile, sealed(std::move(status)).dump(1) + "\n");
}

void remove_damaged_status(const fs::path& directory) {
  const fs::path file = directory / kFile;
  expect_file(file);
  try {
    read_status(directory);
  } catch (const std::runtime_error&) {
    if (may_replace_foreign) return;
    if (fs::is_symlink(file))
      throw UsageError(cannot("replace", file, "it is a link to a file that is not a status; remove the link"));
    const Json there = parse_shallow(read_whole(file));
    if (there.is_object() && !there.empty() && !there.contains("state"))
      expect_own(file, Json{{"state", ""}, {"pairs", 0}}.dump(1));  // refuses another program's file
    std::error_code later;                                          // if this fails, writing the file reports the error
    fs::remove(file, later);
  }
}

Json read_status(const fs::path& directory) {
  const fs::path file = directory / kFile;
  constexpr const char* kRemedy = "the next run of the campaign replaces it";
  Json status = read_sealed(file, kRemedy);
  if (status.is_null()) return status;
  try {
    expect_possible_status(status);
  } catch (const Json::exception&) {
    throw std::runtime_error(cannot("use", file, std::string("it is damaged; ") + kRemedy));
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(cannot("use", file, error.what()));
  }
  return status;
}

}  // namespace graze::fuzz
