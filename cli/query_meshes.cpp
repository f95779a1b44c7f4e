// SPDX-License-Identifier: Apache-2.0
// The output of `graze query --self` and `--between`. With --self, where neighbours always touch, a hit is
// a pair whose triangles pierce each other. With --between, a hit is any pair that intersects.
#include "cli/query_meshes.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/cases.h"
#include "cli/interrupt.h"
#include "cli/mesh_pairs.h"
#include "cli/progress.h"
#include "cli/query_input.h"
#include "cli/results.h"
#include "cli/screen.h"
#include "core/error.h"
#include "core/text.h"
#include "corpus/pair_format.h"
#include "reports/terminal.h"
#include "strata/mesh.h"

namespace graze::cli {
namespace {

using Json = nlohmann::ordered_json;
using reports::grouped;

// Limits on the number of pairs in a file, which is built in memory: for a CSV file (about 3 GB at the limit), and for
// the files of --pairs and --obj.
constexpr std::size_t kMostRows = std::size_t{1} << 26, kMostCases = std::size_t{1} << 22;

struct Search {
  const QueryOptions& options;
  TwoMeshes meshes;
  std::string executor = {};
  FoundPairs found = {};

  bool self() const { return !meshes.b; }
  std::uint64_t hits() const { return self() ? found.of(Kind::pierces) : found.all(); }

  std::vector<FoundPair> list() const {
    std::vector<FoundPair> list = found.pairs;
    if (self()) std::erase_if(list, [](const FoundPair& pair) { return pair.kind != Kind::pierces; });
    return list;
  }
};

Search opened(const QueryOptions& options) {
  const auto read = [](const std::string& file) { return strata::read_triangles(file, strata::Coordinates::any); };
  Search search{options, {read(options.between ? options.files[0] : options.self), {}}};
  if (options.between) search.meshes.b = read(options.files[1]);
  const bool of_doubles = search.meshes.are_doubles() && !options.exact_input;
  for (const strata::MeshPairs* mesh : {&search.meshes.a, search.self() ? nullptr : &*search.meshes.b}) {
    if (mesh) say_notes(of_doubles ? mesh->notes_of_doubles : mesh->notes, mesh->rounding, options.exact_input);
  }
  return search;
}

Kept kept(const Search& search) {
  const QueryOptions& options = search.options;
  if (!options.csv.empty()) return {kMostRows};
  const bool cases = !options.obj.empty() || !options.pairs.empty();
  return {cases ? kMostCases : options.json ? kMostListed : 1, search.self()};
}

// Throws: std::runtime_error if a file would have more pairs than its limit.
void expect_within_limits(const Search& search) {
  const auto expect = [](const std::string& file, std::uint64_t pairs, std::size_t most) {
    if (!file.empty() && pairs > most)
      throw std::runtime_error(fmt::format(
          "cannot write {}: {} pairs are more than the file's limit of {}; omit the file to get only the counts, "
          "or split the mesh",
          file, grouped(pairs), grouped(most)));
  };
  expect(search.options.csv, search.found.all(), kMostRows);
  expect(search.options.pairs, search.hits(), kMostCases);
  expect(search.options.obj, search.hits(), kMostCases);
}

void write_files(const Search& search) {
  const QueryOptions& options = search.options;
  if (!options.csv.empty()) write_result(options.csv, csv_of(search.found.pairs), fuzz::NamedBy::user);
  if (options.pairs.empty() && options.obj.empty()) return;
  std::ostringstream pairs;
  corpus::write_header(pairs);
  ObjGroup hits{search.self() ? "piercing" : "hits", {}};
  for (const FoundPair& hit : search.list()) {
    const DoublePair exact = search.meshes.pair_of_doubles(hit.i, hit.j);
    corpus::Entry entry = search.meshes.are_doubles() ? corpus::entry_of(exact, {})
                                                      : corpus::entry_of(search.meshes.pair(hit.i, hit.j), {});
    entry.fields.push_back({"name", fmt::format("triangles_{}_{}", hit.i, hit.j)});
    corpus::write_entry(pairs, entry);
    hits.triangles.push_back(first_of(exact));
    hits.triangles.push_back(second_of(exact));
  }
  if (!options.pairs.empty()) write_result(options.pairs, pairs.str(), fuzz::NamedBy::user);
  if (!options.obj.empty()) write_result(options.obj, obj_of({hits}), fuzz::NamedBy::user);
}

Json json_of(const Search& search) {
  const FoundPairs& found = search.found;
  const std::vector<FoundPair> list = search.list();
  Json json = {{"triangles", search.meshes.a.triangles.size()}, {"hits", search.hits()}, {"first", nullptr}};
  if (!search.self()) json["triangles"] = {search.meshes.a.triangles.size(), search.meshes.b->triangles.size()};
  if (!list.empty()) json["first"] = {list[0].i, list[0].j};
  json["declined"] = found.declined;
  json["seconds"] = found.seconds;
  json["executor"] = search.executor;
  json["coordinates"] = search.meshes.are_doubles() ? "f64" : "f32";
  json["candidates"] = found.candidates;
  json["piercing"] = found.of(Kind::pierces);
  json["touching"] = found.of(Kind::touches);
  json["common_edge"] = found.of(Kind::common_edge);
  json["common_vertex"] = found.of(Kind::common_vertex);
  json["list"] = Json::array();
  for (const FoundPair& hit : std::span(list).first(std::min(list.size(), kMostListed)))
    json["list"].push_back({{"i", hit.i}, {"j", hit.j}, {"contact", name(hit.contact)}, {"kind", name(hit.kind)}});
  json["not_listed"] = search.hits() - json["list"].size();
  return json;
}

std::string words_of(const Search& search) {
  const FoundPairs& found = search.found;
  const auto s = [](std::uint64_t count, const char* one, const char* more) {
    return grouped(count) + (count == 1 ? one : more);
  };
  const std::uint64_t touching = found.of(Kind::touches), edges = found.of(Kind::common_edge),
                      vertices = found.of(Kind::common_vertex);
  std::string text;
  if (search.self()) {
    text = fmt::format("{} triangles: {} each other, {} otherwise\n", grouped(search.meshes.a.triangles.size()),
                       s(search.hits(), " pair pierces", " pairs pierce"), s(touching, " touches", " touch"));
    text +=
        fmt::format("neighbours that share only an edge: {}; only a vertex: {}\n", grouped(edges), grouped(vertices));
  } else {
    text = fmt::format("{} and {} triangles: {} ({})\n", grouped(search.meshes.a.triangles.size()),
                       grouped(search.meshes.b->triangles.size()),
                       s(search.hits(), " pair intersects", " pairs intersect"), search.executor);
    text += fmt::format("{} each other, {} only an edge, {} only a vertex, {} otherwise\n",
                        s(found.of(Kind::pierces), " pierces", " pierce"), s(edges, " shares", " share"),
                        grouped(vertices), s(touching, " touches", " touch"));
  }
  if (found.declined > 0)
    text += s(found.declined, " triangle was", " triangles were") + " declined: a coordinate is not finite\n";
  if (const std::vector<FoundPair> list = search.list(); !list.empty() && search.self())
    text += fmt::format("the first pair that pierces: triangles {} and {}\n", list[0].i, list[0].j);
  else if (!list.empty())
    text += fmt::format("the first pair: triangle {} of {} and {} of {}\n", list[0].i,
                        printable(search.options.files[0]), list[0].j, printable(search.options.files[1]));
  return text;
}

}  // namespace

void query_meshes(const QueryOptions& options, int& status) {
  if (options.executors[0] == "all-gpus")
    throw UsageError("--self and --between use one GPU at most; name one-core, all-cores or one-gpu");
  if (!options.csv.empty()) expect_replaceable(options.csv, csv_of({}));
  if (!options.pairs.empty()) expect_replaceable(options.pairs, kPairs);
  if (!options.obj.empty()) expect_replaceable(options.obj, obj_of({}));
  Search search = opened(options);
  catch_interrupts();
  const Decider decider = exact_decider(options.executors[0]);
  search.executor = decider.executor;
  const std::size_t triangles = search.meshes.a.triangles.size();
  Progress progress("triangles", triangles, isatty(STDERR_FILENO), error_screen());
  std::size_t done = 0;
  const auto start = std::chrono::steady_clock::now();
  try {
    search.found = find_pairs(search.meshes, decider, kept(search), [&](std::size_t now) {
      done = now;
      const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
      const double left = seconds / static_cast<double>(done) * static_cast<double>(triangles - done);
      if (const auto line = progress.line(done, seconds, left)) fmt::print(stderr, "{}", *line);
    });
  } catch (const Stopped&) {
    fmt::print(stderr, "{}graze: interrupted after {} of {} triangles\n", progress.end(), grouped(done),
               grouped(triangles));
    status = kInterrupted;
    return;
  }
  fmt::print(stderr, "{}", progress.end());
  expect_within_limits(search);
  write_files(search);
  if (options.json)
    fmt::print("{}\n", json_of(search).dump());
  else
    fmt::print("{}", words_of(search));
}

}  // namespace graze::cli
