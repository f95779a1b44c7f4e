// SPDX-License-Identifier: Apache-2.0
// `graze query`: finds the triangles of a mesh that intersect a reference, and compares lanes and executors.
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include <graze/query.h>

#include "backends/backends.h"
#include "cli/cases.h"
#include "cli/commands.h"
#include "cli/interrupt.h"
#include "cli/mesh_pairs.h"
#include "cli/progress.h"
#include "cli/query_input.h"
#include "cli/query_meshes.h"
#include "cli/results.h"
#include "cli/screen.h"
#include "core/error.h"
#include "core/text.h"
#include "corpus/pair_format.h"
#include "fuzz/files.h"
#include "query/question.h"
#include "reports/terminal.h"
#include "reports/text_table.h"
#include "strata/mesh.h"

namespace graze::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostMismatches = 1000;  // mismatches kept as cases
const std::vector<std::string> kExecutors = {"auto", "one-core", "all-cores", "one-gpu", "all-gpus"};

// A lane, an executor, and their verdicts.
struct Run {
  std::string lane, executor;
  query::Answer answer;
  std::vector<std::uint8_t> bytes;
  bool of_doubles = false;
  std::uint64_t failed = 0;  // pairs on which a user's code crashed, timed out or was unstable
};

std::string name_of(int executor) { return kExecutors.at(static_cast<std::size_t>(executor)); }

struct Told {
  const std::atomic<bool>& interrupted;
  Progress progress;
  std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();
};

int tell(void* user, std::uint64_t done, std::uint64_t triangles) {
  Told& told = *static_cast<Told*>(user);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - told.start).count();
  const double left =
      seconds / static_cast<double>(std::max<std::uint64_t>(done, 1)) * static_cast<double>(triangles - done);
  if (const auto line = told.progress.line(done, seconds, left)) fmt::print(stderr, "{}", *line);
  return told.interrupted;
}

template <class Real>
using TrianglesOf = std::vector<TriangleOf<Real>>;

// Returns the pair whose verdict is byte p of a run.
template <class Real>
BasicPair<Real> pair_at(std::size_t p, const TrianglesOf<Real>& references, const TrianglesOf<Real>& triangles) {
  return pair_of(references[p / triangles.size()], triangles[p % triangles.size()]);
}

template <class Real>
corpus::Entry case_at(std::size_t p, const TrianglesOf<Real>& references, const TrianglesOf<Real>& triangles) {
  const std::string name = fmt::format("reference_{}_triangle_{}", p / triangles.size(), p % triangles.size());
  return corpus::entry_of(pair_at(p, references, triangles), {{"name", name}});
}

// Returns the triangles on which some run differs from the first run, with the verdict of each run.
template <class Real>
std::vector<corpus::Entry> mismatches_of(const std::vector<Run>& runs, const TrianglesOf<Real>& references,
                                         const TrianglesOf<Real>& triangles, std::uint64_t& count) {
  std::vector<corpus::Entry> entries;
  for (std::size_t p = 0; p < runs[0].bytes.size(); ++p) {
    if (std::all_of(runs.begin(), runs.end(), [&](const Run& run) { return run.bytes[p] == runs[0].bytes[p]; }))
      continue;
    if (count++ >= kMostMismatches) continue;
    corpus::Entry entry = case_at(p, references, triangles);
    for (const Run& run : runs) {
      std::string key = "said_by_" + run.lane + (run.executor == "auto" ? "" : "_" + run.executor);
      for (char& c : key) c = std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '.' ? c : '_';
      entry.fields.push_back({key, std::string(name(static_cast<Verdict>(run.bytes[p])))});
    }
    entries.push_back(std::move(entry));
  }
  return entries;
}

void write_pairs(const std::string& file, const std::vector<corpus::Entry>& entries) {
  std::ostringstream text;
  corpus::write_header(text);
  for (const corpus::Entry& entry : entries) corpus::write_entry(text, entry);
  write_result(file, text.str(), fuzz::NamedBy::user);
}

// Writes the hits of the first run to files.
template <class Real>
void write_hits(const QueryOptions& options, const Run& run, const TrianglesOf<Real>& references,
                const TrianglesOf<Real>& triangles) {
  std::vector<corpus::Entry> entries;
  std::vector<FoundPair> rows;
  ObjGroup hits{"hits", {}};
  for (std::size_t p = 0; p < run.bytes.size(); ++p) {
    if (run.bytes[p] != 1) continue;
    const std::size_t triangle = p % triangles.size(), reference = p / triangles.size();
    entries.push_back(case_at(p, references, triangles));
    const BasicPair<Real> pair = pair_at(p, references, triangles);
    rows.push_back(related(static_cast<std::uint32_t>(reference), static_cast<std::uint32_t>(triangle), pair));
    hits.triangles.push_back(second_of(pair));
  }
  if (!options.csv.empty()) write_result(options.csv, csv_of(rows), fuzz::NamedBy::user);
  if (!options.pairs.empty()) write_pairs(options.pairs, entries);
  if (options.obj.empty()) return;
  ObjGroup asked{"reference", {}};
  for (const auto& reference : references) asked.triangles.push_back(first_of(pair_of(reference, reference)));
  write_result(options.obj, obj_of({asked, hits}), fuzz::NamedBy::user);
}

// Returns why verdicts computed on cores are those of a CUDA lane; empty for other lanes.
std::string evidence_of(const Run& run) {
  const Lane* lane = find_lane(run.lane);
  const bool on_cores = run.answer.executor == GRAZE_ONE_CORE || run.answer.executor == GRAZE_ALL_CORES;
  return lane && on_cores ? backends::backend_of(*lane).evidence(*lane, run.of_doubles) : "";
}

// A query counts failures of a user's code as declined verdicts; this function finds the failures among them.
template <class Real>
void find_failures(Run& run, const TrianglesOf<Real>& references, const TrianglesOf<Real>& triangles) {
  const Lane* lane = find_lane(run.lane);
  if (!lane || !lane->foreign) return;
  for (std::size_t p = 0; p < run.bytes.size(); ++p) {
    if (run.bytes[p] != static_cast<std::uint8_t>(Verdict::declined)) continue;
    const BasicPair<Real> pair = pair_at(p, references, triangles);
    if (!is_finite(pair)) continue;
    Verdict verdict = decide_one(lane->decide, pair);
    if (verdict != Verdict::declined && !is_failure(verdict)) verdict = Verdict::unstable;  // it failed in the query
    run.bytes[p] = static_cast<std::uint8_t>(verdict);
    run.failed += verdict != Verdict::declined;
  }
}

Json json_of(const Run& run) {
  Json first = nullptr;
  if (run.answer.hits > 0) first = run.answer.first;
  Json json = {{"triangles", run.answer.triangles},
               {"hits", run.answer.hits},
               {"first", first},
               {"declined", run.answer.declined - run.failed},
               {"seconds", run.answer.seconds},
               {"lane", run.lane},
               {"executor", name_of(run.answer.executor)}};
  if (run.failed > 0) json["failed"] = run.failed;
  if (const std::string evidence = evidence_of(run); !evidence.empty()) json["evidence"] = evidence;
  return json;
}

// Adds the first hits: a triangle's index or, if there are several references, a reference's and a triangle's.
void add_list(Json& json, const Run& run, std::size_t triangles, std::size_t references) {
  json["list"] = Json::array();
  for (std::size_t p = 0; p < run.bytes.size() && json["list"].size() < kMostListed; ++p) {
    if (run.bytes[p] != 1) continue;
    json["list"].push_back(references == 1 ? Json(p) : Json({p / triangles, p % triangles}));
  }
  json["not_listed"] = run.answer.hits - json["list"].size();
}

// Two runs, and the number of triangles on which they differ.
struct Differing {
  const Run *first, *second;
  std::uint64_t count = 0;
};
std::vector<Differing> differing(const std::vector<Run>& runs) {
  std::vector<Differing> found;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    for (std::size_t s = r + 1; s < runs.size(); ++s) {
      found.push_back({&runs[r], &runs[s]});
      for (std::size_t p = 0; p < runs[r].bytes.size(); ++p) found.back().count += runs[r].bytes[p] != runs[s].bytes[p];
    }
  }
  return found;
}

// One row for each combination of two runs. A row names the executors if its lanes are the same.
std::string table_of(const std::vector<Differing>& rows) {
  const auto name = [](const Run& run, const Run& other) {
    return run.lane == other.lane ? fmt::format("{} {}", run.lane, run.executor) : run.lane;
  };
  reports::TextTable table({{"", reports::Align::left}, {"", reports::Align::left}, {"differ on"}});
  for (const Differing& row : rows)
    table.add({{name(*row.first, *row.second)}, {name(*row.second, *row.first)}, {reports::grouped(row.count)}});
  return table.text(output_screen());
}

std::string words_of(const Run& run, bool any, std::size_t references) {
  const query::Answer& answer = run.answer;
  const std::string reference = references == 1 ? "the reference" : fmt::format("one of {} references", references);
  std::string text =
      any ? answer.hits ? fmt::format("triangle {} meets {}", answer.first, reference)
                        : fmt::format("no triangle of {} meets {}", reports::grouped(answer.triangles), reference)
          : fmt::format("{} of {} triangles meet{} {}", reports::grouped(answer.hits),
                        reports::grouped(answer.triangles), answer.hits == 1 ? "s" : "", reference);
  if (references > 1 && !any)
    text = fmt::format("{} hits among {} triangles and {} references", reports::grouped(answer.hits),
                       reports::grouped(answer.triangles), references);
  if (!any && answer.hits > 0) text += fmt::format(", the first is {}", answer.first);
  if (answer.declined > run.failed)
    text += fmt::format("; {} declined", reports::grouped(answer.declined - run.failed));
  if (run.failed > 0) text += fmt::format("; crashed, timed out or was unstable on {}", reports::grouped(run.failed));
  return text + fmt::format(" ({}, {}{})\n", run.lane, name_of(answer.executor),
                            evidence_of(run).empty() ? "" : ", by its twin");
}

template <class Real>
std::vector<Run> runs_of(const QueryOptions& options, const QueryLanes& lanes, const TrianglesOf<Real>& references,
                         const TrianglesOf<Real>& triangles, int& status) {
  std::vector<Run> runs;
  for (const std::string& lane : lanes.ids) {
    for (const std::string& executor : options.executors)
      runs.push_back({lane, executor, {}, {}, std::is_same_v<Real, double>});
  }
  if (runs.size() == 1 && !options.mismatches.empty())
    throw UsageError(
        "--mismatches is for lanes or executors that are compared; name several with --lanes or "
        "--executor");
  if (options.any && runs.size() > 1) throw UsageError("--any works only with one lane and one executor");
  query::on_cores = backends::on_host;  // includes twins
  const query::Context context;
  const std::atomic<bool>& interrupted = catch_interrupts();
  for (Run& run : runs) {
    Told told{interrupted, Progress("triangles", triangles.size(), isatty(STDERR_FILENO), error_screen())};
    const graze_triangles part = query::rows_of(std::span(triangles));
    const std::array<Real, 9> any{};  // only for its type; the references are set below
    graze_query query = query::query_of(any, part);
    query.references = references.data();
    query.reference_count = references.size();
    query.lane = run.lane.c_str();
    query.executor =
        static_cast<int>(std::find(kExecutors.begin(), kExecutors.end(), run.executor) - kExecutors.begin());
    query.mode = options.any ? GRAZE_ANY : GRAZE_ALL;
    query.progress = tell;
    query.user = &told;
    if (!options.any) run.bytes.resize(triangles.size() * references.size());
    query.bytes = options.any ? nullptr : run.bytes.data();
    run.answer = context.run(query);
    fmt::print(stderr, "{}", told.progress.end());
    if (run.answer.status == GRAZE_CANCELLED) {
      fmt::print(stderr, "graze: interrupted after {} triangles\n", reports::grouped(run.answer.position));
      status = kInterrupted;
      return {};
    }
    if (run.answer.status == GRAZE_BAD_ARGUMENT) throw UsageError(std::string(run.answer.what()));
    if (!run.answer) throw std::runtime_error(std::string(run.answer.what()));
    find_failures(run, references, triangles);
  }
  return runs;
}

void expect_different_files(const QueryOptions& options) {
  std::set<std::filesystem::path> files;
  for (const std::string& file : {options.csv, options.obj, options.pairs, options.mismatches}) {
    std::error_code no_file;  // a pipe has no path
    const std::filesystem::path path = std::filesystem::absolute(file, no_file),
                                place = std::filesystem::weakly_canonical(path, no_file);
    if (!file.empty() && !files.insert(no_file ? path : place).second)
      throw UsageError("--csv, --obj, --pairs and --mismatches need different files, but two of them name " +
                       shown_path(file));
  }
}

// --self and --between.
void query_all_pairs(const QueryOptions& options, int& status) {
  if (options.any || !options.lanes.globs.empty() || !options.lanes.subjects.empty() ||
      !options.lanes.toolchains.empty() || !options.mismatches.empty() || options.executors.size() > 1)
    throw UsageError(
        "--self and --between are exact and use one executor; leave out --any, --lanes, --subject, --toolchains and "
        "--mismatches, and name one --executor");
  if (options.between && options.files.size() != 2)
    throw UsageError(fmt::format("--between needs two meshes, but got {}", options.files.size()));
  query_meshes(options, status);
}

template <class Real>
void answer(const QueryOptions& options, const QueryLanes& lanes, const TrianglesOf<Real>& references,
            const TrianglesOf<Real>& triangles, int& status) {
  const std::vector<Run> runs = runs_of(options, lanes, references, triangles, status);
  if (runs.empty()) return;
  write_hits(options, runs[0], references, triangles);
  std::uint64_t count = 0;
  std::vector<corpus::Entry> mismatches;
  if (runs.size() > 1) mismatches = mismatches_of(runs, references, triangles, count);
  const std::string kept = options.mismatches.empty() ? "mismatches.pairs" : options.mismatches;
  if (!mismatches.empty()) write_pairs(kept, mismatches);
  if (options.json) {
    Json json = json_of(runs[0]);
    if (!options.any) add_list(json, runs[0], triangles.size(), references.size());
    if (runs.size() > 1) {
      json["mismatches"] = count;
      for (const Differing& row : differing(runs))
        json["differing"].push_back({{"lanes", {row.first->lane, row.second->lane}},
                                     {"executors", {row.first->executor, row.second->executor}},
                                     {"triangles", row.count}});
      for (std::size_t r = 1; r < runs.size(); ++r) json["others"].push_back(json_of(runs[r]));
    }
    fuzz::add_left_out(json, lanes.under_test);
    fmt::print("{}\n", json.dump());
    return;
  }
  for (const Run& run : runs) fmt::print("{}", words_of(run, options.any, references.size()));
  if (runs.size() == 1) return;
  if (runs.size() > 2 && count > 0) fmt::print("{}", table_of(differing(runs)));
  if (count == 0) {
    fmt::print("no mismatch\n");
    return;
  }
  fmt::print("{} mismatch{}, {} of them kept in {}\n", reports::grouped(count), count == 1 ? "" : "es",
             mismatches.size(), printable(kept));
  fmt::print("Next: graze explain {}\n", path_word(kept));
}

void query_mesh(const QueryOptions& options, int& status) {
  if (options.files.size() != 2)
    throw UsageError(
        fmt::format("graze query needs two files, a reference and a mesh, but got {}", options.files.size()));
  if (options.any && (!options.csv.empty() || !options.obj.empty() || !options.pairs.empty()))
    throw UsageError("--any does not work with --csv, --obj or --pairs, which write all hits");
  const strata::MeshPairs of_references = read_references(options.files[0]),
                          of_mesh = strata::read_triangles(options.files[1], strata::Coordinates::any);
  const QueryLanes lanes = query_lanes(options.lanes, {"exact"});
  const bool has_doubles = of_references.rounding.beyond > 0 || of_mesh.rounding.beyond > 0,
             are_doubles = has_doubles && lanes.ids == std::vector<std::string>{"exact"};
  say_notes(of_references, of_mesh, options.exact_input, are_doubles);
  if (has_doubles && !are_doubles && matches_any(lanes.ids, "exact"))
    fmt::print(stderr,
               "graze: exact decides the rounded triangles too, because the other lanes take float32; as the only "
               "lane, exact decides the doubles\n");
  are_doubles
      ? answer<double>(options, lanes, of_references.triangles_in_doubles(), of_mesh.triangles_in_doubles(), status)
      : answer<float>(options, lanes, of_references.triangles, of_mesh.triangles, status);
}

}  // namespace

void add_query(CLI::App& app, int& status) {
  CLI::App* command = app.add_subcommand("query",
                                         "Find the triangles of a mesh that meet a reference triangle, or all pairs "
                                         "that intersect within a mesh or between "
                                         "two");
  command->footer(
      "Exit status: 0 whatever is found; 1 if a file\ncannot be read or written, or there is no GPU;\n2 for wrong use; "
      "130 if interrupted while\nit decides.\n\n"
      "Example: graze query arm.off#0 arm.off --json\n"
      "Example: graze query --self arm.off --csv pairs.csv\n"
      "Example: graze query arm.off table.off --between --csv pairs.csv");
  auto options = std::make_shared<QueryOptions>();
  add_valued(
      *command, "files", options->files, "REF MESH",
      "Reference triangle (a text file of nine numbers, or MESH#FACE) and mesh (" + strata::mesh_formats() + ")");
  add_valued(*command, "--self", options->self, "MESH",
             "Mesh to test against itself, instead of REF MESH; finds the triangles that pierce each other")
      ->excludes("files");
  command
      ->add_flag("--between", options->between,
                 "Find all intersecting pairs of two meshes, which are given instead of REF MESH")
      ->excludes("--self");
  CLI::Option* any = command->add_flag("--any", options->any, "Stop at the first hit");
  command->add_flag("--all", options->all, "Find all hits (default)")->excludes(any);
  add_valued(*command, "--executor", options->executors, "auto|one-core|all-cores|one-gpu|all-gpus,…",
             "Executors that decide; several are compared")
      ->delimiter(',')
      ->transform(one_of(kExecutors, Chosen::word))
      ->default_str("auto");
  add_globs(*command, "--lanes", options->lanes.globs, "Patterns of the lanes that decide; several are compared")
      ->default_str("exact, and those of --subject");
  add_subject_options(*command, options->lanes);
  add_exact_input(*command, options->exact_input);
  command->add_flag("--json", options->json, "Print one JSON object; it lists the first 100,000 hits");
  add_valued(*command, "--csv", options->csv, "FILE",
             "CSV file for the pairs that intersect: indices of the faces, contact and kind");
  add_valued(*command, "--obj", options->obj, "FILE", "OBJ file for the reference and the hits");
  add_valued(*command, "--pairs", options->pairs, "FILE", "File of pairs for the hits");
  add_valued(*command, "--mismatches", options->mismatches, "FILE",
             "File for triangles on which lanes or executors disagree")
      ->default_str("mismatches.pairs");
  command->callback([options, &status] {
    expect_different_files(*options);
    if (options->between || !options->self.empty()) return query_all_pairs(*options, status);
    query_mesh(*options, status);
  });
}

}  // namespace graze::cli
