// SPDX-License-Identifier: Apache-2.0
#include "fuzz/campaign/store.h"

#include <algorithm>

#include "core/error.h"

namespace graze::fuzz {
namespace {

constexpr int kApplicationId = 0x67726173;  // "gras"
constexpr int kFormat = 4;

constexpr const char* kSchema = R"(
CREATE TABLE meta(key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE done(source INTEGER PRIMARY KEY, pairs INTEGER NOT NULL);
CREATE TABLE total(name TEXT PRIMARY KEY, count INTEGER NOT NULL) WITHOUT ROWID;
CREATE TABLE margin(source INTEGER, bucket INTEGER, pairs INTEGER NOT NULL, intersects INTEGER NOT NULL,
  PRIMARY KEY(source, bucket)) WITHOUT ROWID;
CREATE TABLE wrong(source INTEGER, lane INTEGER, bucket INTEGER, false_positive INTEGER NOT NULL, false_negative INTEGER NOT NULL,
  declined INTEGER NOT NULL, differs_from_cpu INTEGER NOT NULL, PRIMARY KEY(source, lane, bucket)) WITHOUT ROWID;
CREATE TABLE extreme(source INTEGER, bucket INTEGER, pairs INTEGER NOT NULL, intersects INTEGER NOT NULL,
  PRIMARY KEY(source, bucket)) WITHOUT ROWID;
CREATE TABLE extreme_wrong(source INTEGER, lane INTEGER, bucket INTEGER, false_positive INTEGER NOT NULL, false_negative INTEGER NOT NULL,
  declined INTEGER NOT NULL, differs_from_cpu INTEGER NOT NULL, PRIMARY KEY(source, lane, bucket)) WITHOUT ROWID;
CREATE TABLE signature(id INTEGER PRIMARY KEY, kind TEXT NOT NULL, key TEXT NOT NULL, count INTEGER NOT NULL, UNIQUE(kind, key));
CREATE TABLE kept(signature INTEGER, case_index INTEGER, source INTEGER, PRIMARY KEY(signature, case_index, source)) WITHOUT ROWID;
)";

std::filesystem::path database_file(const std::filesystem::path& directory) {
  std::error_code error;
  std::filesystem::create_directories(directory / "cases", error);
  if (error) {
    throw UsageError(directory.string() + ": expected a directory that can be written, found: " + error.message());
  }
  return directory / "campaign.sqlite";
}

std::int64_t integer(const Database& database, const char* sql) {
  Statement query(database, sql);
  return query.step() ? query.integer(0) : 0;
}

std::int64_t total(const Database& database, std::string_view name) {
  Statement query(database, "SELECT count FROM total WHERE name = ?");
  return query(name).step() ? query.integer(0) : 0;
}

// Adds the tally to two tables of its own: of pairs, and of the lanes' errors.
void add_tally(const Database& database, const std::string& pairs, const std::string& wrong, int source,
               const analysis::Tally& tally) {
  Statement add_pairs(database, ("INSERT INTO " + pairs +
                                 " VALUES(?1, ?2, ?3, ?4) ON CONFLICT DO UPDATE SET pairs = pairs + ?3, "
                                 "intersects = intersects + ?4")
                                    .c_str());
  Statement add_wrong(database, ("INSERT INTO " + wrong +
                                 " VALUES(?1, ?2, ?3, ?4, ?5, ?6, ?7) ON CONFLICT DO UPDATE SET false_positive = "
                                 "false_positive + ?4, false_negative = false_negative + ?5, declined = declined + ?6, "
                                 "differs_from_cpu = differs_from_cpu + ?7")
                                    .c_str());
  for (int b = -kBucketMost; b <= kBucketMost; ++b) {
    const Bucket bucket = static_cast<Bucket>(b);
    if (tally.pairs(bucket) == 0) continue;
    add_pairs(source, b, tally.pairs(bucket), tally.intersects(bucket)).run();
    for (int l = 0; l < tally.lane_count(); ++l) {
      const analysis::LaneCounts& lane = tally.lane(l, bucket);
      if (lane.any())
        add_wrong(source, l, b, lane.false_positive, lane.false_negative, lane.declined, lane.differs_from_cpu).run();
    }
  }
}

// Names the first field in which two specs differ.
std::string first_difference(const Json& expected, const Json& found) {
  for (const auto& [key, value] : expected.items()) {
    if (!found.contains(key) || found[key] != value) return key;
  }
  return "fields";
}

}  // namespace

void SignatureCount::keep(const CaseKey& found) {
  if (cases.size() == kKeptCases && cases.back() < found) return;
  cases.insert(std::upper_bound(cases.begin(), cases.end(), found), found);
  if (cases.size() > kKeptCases) cases.pop_back();
}

void SignatureCount::add(const CaseKey& found) {
  ++count;
  keep(found);
}

void SignatureCount::add(const SignatureCount& other) {
  count += other.count;
  for (const CaseKey& found : other.cases) keep(found);
}

void BatchResult::add(const BatchResult& other) {
  tally.add(other.tally);
  extremes.add(other.extremes);
  for (const auto& [signature, found] : other.signatures) signatures[signature].add(found);
  for (const auto& [lane, found] : other.executors_apart) executors_apart[lane].add(found);
  disagreements += other.disagreements;
  cgal += other.cgal;
  gmp += other.gmp;
  device += other.device;
}

Store::Store(const std::filesystem::path& directory, const Json& spec, const Json& build)
    : database_(database_file(directory)) {
  const std::string file = (directory / "campaign.sqlite").string();
  const std::int64_t application = integer(database_, "PRAGMA application_id");
  const bool fresh = application == 0 && integer(database_, "SELECT count(*) FROM sqlite_schema") == 0;
  if (!fresh && application != kApplicationId) {
    throw std::runtime_error(file + ": expected a Graze campaign database, found another program's");
  }
  if (fresh && std::filesystem::exists(directory / "summary.json")) {
    throw UsageError(directory.string() + ": holds results but not their database; choose another --out");
  }
  // One process a campaign. A write-ahead log: a killed process loses only the transaction under way.
  database_.execute("PRAGMA locking_mode = EXCLUSIVE; PRAGMA journal_mode = WAL; PRAGMA synchronous = NORMAL;");
  if (fresh) {
    database_.execute("BEGIN IMMEDIATE");
    database_.execute(kSchema);
    Statement put(database_, "INSERT INTO meta VALUES(?, ?)");
    put(std::string_view("spec"), spec.dump()).run();
    put(std::string_view("build"), build.dump()).run();
    database_.execute(("PRAGMA application_id = " + std::to_string(kApplicationId) +
                       "; PRAGMA user_version = " + std::to_string(kFormat))
                          .c_str());
    database_.execute("COMMIT");
    return;
  }
  if (const auto format = integer(database_, "PRAGMA user_version"); format != kFormat) {
    throw std::runtime_error(file + ": expected format " + std::to_string(kFormat) + ", found " +
                             std::to_string(format));
  }
  Statement quick_check(database_, "PRAGMA quick_check(1)");
  if (!quick_check.step() || quick_check.text(0) != "ok")
    throw std::runtime_error(file + ": expected a whole database, found damage: " + quick_check.text(0));

  Statement get(database_, "SELECT value FROM meta WHERE key = ?");
  const auto meta = [&](std::string_view key) { return get(key).step() ? get.text(0) : std::string(); };
  const Json found_spec = Json::parse(meta("spec"), nullptr, false),
             found_build = Json::parse(meta("build"), nullptr, false);
  if (found_spec != spec) {
    throw UsageError(directory.string() + ": holds another campaign (expected the same " +
                     first_difference(spec, found_spec) + "); choose another --out");
  }
  if (found_build != build) {
    throw UsageError(directory.string() + ": was begun by another build (expected the same " +
                     first_difference(build, found_build) + "); choose another --out");
  }
}

std::uint64_t Store::done(int source) const {
  Statement query(database_, "SELECT pairs FROM done WHERE source = ?");
  return query(source).step() ? static_cast<std::uint64_t>(query.integer(0)) : 0;
}

void Store::commit(int source, std::uint64_t pairs, const BatchResult& result) {
  database_.execute("BEGIN IMMEDIATE");
  try {
    add_tally(database_, "margin", "wrong", source, result.tally);
    add_tally(database_, "extreme", "extreme_wrong", source, result.extremes);
    Statement add_total(database_, "INSERT INTO total VALUES(?1, ?2) ON CONFLICT DO UPDATE SET count = count + ?2");
    add_total(std::string_view("disagreements"), result.disagreements).run();
    add_total(std::string_view("cgal"), result.cgal).run();
    add_total(std::string_view("gmp"), result.gmp).run();
    add_total(std::string_view("device"), result.device).run();

    Statement add_signature(
        database_,
        "INSERT INTO signature(kind, key, count) VALUES(?1, ?2, ?3) ON CONFLICT DO UPDATE SET count = count + ?3 "
        "RETURNING id");
    Statement keep(database_, "INSERT INTO kept VALUES(?, ?, ?)");
    Statement kept(database_, "SELECT count(*), max(case_index) FROM kept WHERE signature = ?");
    Statement trim(database_,
                   "DELETE FROM kept WHERE signature = ?1 AND (case_index, source) NOT IN "
                   "(SELECT case_index, source FROM kept WHERE signature = ?1 ORDER BY case_index, source LIMIT ?2)");
    const auto add = [&](std::string_view kind, const std::string& name, const SignatureCount& found) {
      add_signature(kind, name, found.count).step();
      const auto id = add_signature.integer(0);
      add_signature.run();
      kept(id).step();
      const bool full = static_cast<std::size_t>(kept.integer(0)) >= kKeptCases;
      const auto largest = static_cast<std::uint64_t>(kept.integer(1));
      for (const CaseKey& c : found.cases) {
        if (!full || c.index <= largest) keep(id, c.index, c.source).run();
      }
      trim(id, kKeptCases).run();
    };
    for (const auto& [signature, found] : result.signatures) add("signature", analysis::key(signature), found);
    for (const auto& [lane, found] : result.executors_apart) add("executors_apart", lane, found);
    Statement(database_, "INSERT INTO done VALUES(?1, ?2) ON CONFLICT DO UPDATE SET pairs = pairs + ?2")(source, pairs)
        .run();
    database_.execute("COMMIT");
  } catch (...) {
    sqlite3_exec(database_.handle(), "ROLLBACK", nullptr, nullptr, nullptr);
    throw;
  }
}

std::map<std::string, SignatureCount> Store::signatures() const { return counts_of("signature"); }

std::map<std::string, SignatureCount> Store::executors_apart() const { return counts_of("executors_apart"); }

std::map<std::string, SignatureCount> Store::counts_of(std::string_view kind) const {
  std::map<std::string, SignatureCount> all;
  Statement query(database_,
                  "SELECT key, count, case_index, source FROM signature JOIN kept ON signature = id WHERE kind = ? "
                  "ORDER BY key, case_index, source");
  query(kind);
  while (query.step()) {
    SignatureCount& found = all[query.text(0)];
    found.count = static_cast<std::uint64_t>(query.integer(1));
    found.cases.push_back({static_cast<std::uint64_t>(query.integer(2)), static_cast<int>(query.integer(3))});
  }
  return all;
}

std::uint64_t Store::signature_count() const {
  return static_cast<std::uint64_t>(integer(database_, "SELECT count(*) FROM signature WHERE kind = 'signature'"));
}

Json Store::results(const std::vector<strata::PairSource>& sources, const std::vector<std::string>& lanes) const {
  Json strata = Json::object();
  for (const strata::PairSource& source : sources) {
    Json& row =
        strata[source.id] = {{"pairs", 0}, {"intersects", 0}, {"lanes", Json::object()}, {"margins", Json::object()}};
    for (const std::string& lane : lanes)
      row["lanes"][lane] = {{"false_positive", 0}, {"false_negative", 0}, {"declined", 0}, {"differs_from_cpu", 0}};
    if (source.axis != Axis::none) row["extremes"][std::string(name(source.axis))] = Json::object();
  }
  const auto source_at = [&](const Statement& row) -> const strata::PairSource& {
    return sources.at(static_cast<std::size_t>(row.integer(0)));
  };
  const auto add = [](Json& total, std::int64_t more) { total = total.get<std::int64_t>() + more; };
  const auto errors = [](const Statement& row) { return row.integer(3) + row.integer(4) + row.integer(5); };
  Statement margins(database_, "SELECT source, bucket, pairs, intersects FROM margin ORDER BY source, bucket");
  while (margins.step()) {
    Json& row = strata[source_at(margins).id];
    add(row["pairs"], margins.integer(2));
    add(row["intersects"], margins.integer(3));
    row["margins"][name_of_bucket(static_cast<Bucket>(margins.integer(1)))] = {{"pairs", margins.integer(2)},
                                                                               {"wrong", Json::object()}};
  }
  Statement wrong(database_,
                  "SELECT source, lane, bucket, false_positive, false_negative, declined, differs_from_cpu FROM wrong "
                  "ORDER BY source, lane, bucket");
  while (wrong.step()) {
    Json& row = strata[source_at(wrong).id];
    const std::string& lane = lanes.at(static_cast<std::size_t>(wrong.integer(1)));
    Json& counts = row["lanes"][lane];
    add(counts["false_positive"], wrong.integer(3));
    add(counts["false_negative"], wrong.integer(4));
    add(counts["declined"], wrong.integer(5));
    add(counts["differs_from_cpu"], wrong.integer(6));
    if (errors(wrong))
      row["margins"][name_of_bucket(static_cast<Bucket>(wrong.integer(2)))]["wrong"][lane] = errors(wrong);
  }
  const auto extreme = [&](const strata::PairSource& source, std::int64_t bucket) -> Json& {
    const int exponent = exponent_of(source.axis, static_cast<std::int8_t>(bucket));
    return strata[source.id]["extremes"][std::string(name(source.axis))][std::to_string(exponent)];
  };
  Statement extremes(database_, "SELECT source, bucket, pairs FROM extreme ORDER BY source, bucket");
  while (extremes.step())
    extreme(source_at(extremes), extremes.integer(1)) = {{"pairs", extremes.integer(2)}, {"wrong", Json::object()}};
  Statement extreme_wrong(database_,
                          "SELECT source, lane, bucket, false_positive, false_negative, declined FROM extreme_wrong "
                          "ORDER BY source, lane, bucket");
  while (extreme_wrong.step()) {
    if (errors(extreme_wrong) == 0) continue;
    extreme(source_at(extreme_wrong),
            extreme_wrong.integer(2))["wrong"][lanes.at(static_cast<std::size_t>(extreme_wrong.integer(1)))] =
        errors(extreme_wrong);
  }
  return {{"strata", strata}, {"disagreements", total(database_, "disagreements")}};
}

Json Store::oracle() const {
  // The last is always 0: a campaign that finds two exact decisions apart stops before it stores anything.
  return {{"cgal", total(database_, "cgal")},
          {"gmp", total(database_, "gmp")},
          {"device", total(database_, "device")},
          {"apart", 0}};
}

}  // namespace graze::fuzz
