// SPDX-License-Identifier: Apache-2.0
#include "subjects/subjects.h"

#include <fmt/format.h>

#include <algorithm>
#include <deque>
#include <iterator>
#include <map>
#include <optional>

#include "core/error.h"
#include "core/fnv1a.h"
#include "core/lanes/lanes.h"
#include "core/plain_file.h"
#include "core/stop.h"
#include "core/text.h"
#include "cuda/subject/cuda_subject.h"
#include "cuda/twin/twin.h"
#include "subjects/code_hash.h"
#include "subjects/contraction_plan.h"
#include "subjects/cuda_code.h"
#include "subjects/opencl_code.h"
#include "subjects/process.h"
#include "subjects/program_description.h"
#include "subjects/published.h"
#include "subjects/source_build.h"

namespace graze::subjects {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

// An open subject. The lane table points to entries, so they are never freed.
struct Entry {
  Opened opened;
  std::string source, coplanar, degenerate;  // of `info`
  AlgorithmInfo info;
  std::map<std::string, std::unique_ptr<ForeignProcesses>> running;  // by the lane's name within the subject: "f64/cpu"
  std::vector<cuda::CudaBuild> builds;                               // for CUDA code: one for each lane
  std::vector<std::shared_ptr<const SealedCopy>> twins;  // one for each build; null if the build has no twin
  struct FromToolchain {
    Toolchain toolchain;
    std::string build, compiler;  // its cached program; empty if that cannot be built or run here
  };
  std::deque<FromToolchain> from_toolchains = {};
};

std::deque<Entry>& entries() {
  static std::deque<Entry> all;
  return all;
}

// Null if no subject is open under this name.
Entry* find_entry(std::string_view name) {
  const auto found = std::find_if(entries().begin(), entries().end(),
                                  [&](const Entry& entry) { return entry.opened.wanted.name == name; });
  return found == entries().end() ? nullptr : &*found;
}

constexpr std::string_view kCommand = "cmd:", kPublished = "published";
constexpr std::size_t kLongestFunction = 4096;

// "library", "cuda", "opencl", "hip" or "source", by the file's extension; empty for others.
std::string kind_of(std::string_view file) {
  const std::size_t version = file.find_last_not_of("0123456789.") + 1;  // libx.so.1.2
  if (file.substr(0, version).ends_with(".so") || file.ends_with(".dylib")) return "library";
  if (file.ends_with(".cu")) return "cuda";
  if (file.ends_with(".cl")) return "opencl";
  if (file.ends_with(".hip")) return "hip";
  for (const std::string_view ending : {".cpp", ".cc", ".cxx", ".c", ".h", ".hpp", ".hxx", ".hh"})  // headers are C++
    if (file.ends_with(ending)) return "source";
  return "";
}

// A lane of the published algorithm with this name; null if there is none.
const Lane* find_published(std::string_view name) {
  const auto found = std::find_if(published_lanes().begin(), published_lanes().end(),
                                  [&](const Lane& row) { return row.info->id == name; });
  return found == published_lanes().end() ? nullptr : &*found;
}

// Foreign code and compilers run with their own /dev/shm (subjects/containment.h).
void expect_visible(const std::string& name, const fs::path& file) {
  if (fs::weakly_canonical(file).string().starts_with("/dev/shm/"))
    throw std::runtime_error(fmt::format(
        "--subject {}: {} is in /dev/shm, which foreign code and compilers cannot see; copy it to another folder", name,
        shown_path(file.string())));
}

Opened parsed(const Wanted& wanted) {
  Opened result;
  result.wanted = wanted;
  if (wanted.what == kPublished) {
    const Lane* lane = find_published(wanted.name);
    if (!lane) throw std::runtime_error("no published algorithm has the name " + shown(wanted.name));
    result.kind = kPublished;
    result.file = published_source(*lane);
    result.function = kPublishedFunction;
    result.hash = result.code.hash = fnv1a(code_in(result.file));
    return result;
  }
  const bool blank = wanted.what.find_first_not_of(" \t\n", kCommand.size()) == std::string::npos;
  if (wanted.what.starts_with(kCommand) && !blank) {
    if (const std::string missing = missing_program(wanted.what.substr(kCommand.size())); !missing.empty())
      throw std::runtime_error(fmt::format("--subject {}: there is no program {}", wanted.name, shown(missing)));
    result.kind = "command";
    result.wanted.flags.clear();  // nothing compiles it
    result.code = hash_of_command(wanted.what.substr(kCommand.size()));
    for (const HashedFile& named : result.code.files) expect_visible(wanted.name, named.file);
    result.hash = result.code.hash;
    return result;
  }
  const std::string_view what = wanted.what;
  std::size_t end = what.size();  // the end of the file name; a colon and a function may follow
  while (end != what.npos && kind_of(what.substr(0, end)).empty())
    end = end == 0 ? what.npos : what.rfind(':', end - 1);
  if (end == what.npos || end + 1 == what.size()) {
    throw UsageError(fmt::format(
        "--subject {}: expected FILE.so, FILE.cpp, FILE.h, FILE.c, FILE.cu, FILE.cl or cmd:COMMAND, found {}{}",
        wanted.name, shown(what),
        what.find(".py") == what.npos ? ""
                                      : "; `graze try FILE.py:FUNCTION` writes a program that calls the function, "
                                        "and names its command"));
  }
  result.file = what.substr(0, end);
  if (end < what.size()) result.function = what.substr(end + 1);
  const auto fits = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || std::string_view("_:/$.<>, ").find(c) != std::string::npos;
  };
  if (result.function.size() > kLongestFunction || !std::all_of(result.function.begin(), result.function.end(), fits))
    throw UsageError(
        fmt::format("--subject {}: expected the name of a function, found {}", wanted.name, shown(result.function)));
  result.kind = kind_of(what.substr(0, end));
  const auto is_written = [](unsigned char c) { return c >= ' ' && c != '"' && c != '\\' && c != 0x7f; };
  if (const std::string name = result.file;
      result.kind != "library" && !std::all_of(name.begin(), name.end(), is_written))
    throw UsageError(
        fmt::format("--subject {}: no compiler reads a file named {}; rename it, without quotes, "
                    "backslashes and control characters",
                    wanted.name, shown_path(name)));
  if (result.kind != "library" && result.kind != "opencl") expect_visible(wanted.name, result.file);
  const std::string bytes = wanted.builds.empty() ? code_in(result.file) : "";
  result.code = {fnv1a(bytes), "the libraries that it loads"};  // replaced when a source is built
  result.hash = result.code.hash;
  if (result.kind == "library" || result.kind == "opencl") {
    result.wanted.flags.clear();
    result.content = std::make_shared<SealedCopy>(result.file.filename().string(), bytes);
  }
  return result;
}

// The text for a kind of pair: a note if the subject's convention excludes this kind, or else `otherwise`.
std::string says(const Description& description, unsigned outside, std::string_view otherwise) {
  if (!(description.outside & outside)) return std::string(otherwise);
  return "not in its contract" + (description.convention.empty() ? "" : ": " + description.convention);
}

void describe_info(Entry& entry, const Description& description) {
  entry.source = entry.opened.wanted.what;
  if (!description.source.empty()) entry.source += ": " + description.source;
  if (!description.version.empty()) entry.source += ", version " + description.version;
  entry.coplanar = says(description, kOutsideCoplanar, "not said");
  entry.degenerate = says(description, kOutsideDegenerate, "not said");
  entry.info = {entry.opened.wanted.name, entry.source, entry.coplanar, entry.degenerate, "not said", false};
}

// The row of a lane that has no processes yet.
Lane lane_row(const AlgorithmInfo* info, Scalar scalar, Variant variant, unsigned outside) {
  return {"", info, scalar, variant, "", {}, -1, nullptr, false, false, true, outside, "", ""};
}

void add_lane(Entry& entry, std::vector<Lane>& lanes, Code code, Lane lane) {
  auto processes = std::make_unique<ForeignProcesses>(std::move(code), lane.scalar);
  lane.decide = *processes;
  if (!entry.running.emplace(lane.lane_name().within_subject(), std::move(processes)).second)
    throw std::logic_error(lane.lane_name().within_subject() + ": the subject already has this lane");
  lanes.push_back(std::move(lane));
}

LaneName lane_name(const std::string& subject, const cuda::CudaBuild& build) {
  return {subject, std::string(name(build.scalar)), std::string(name(build.variant)), ""};
}

// The evidence for this build from the proof record beside the source, or the build's own evidence if no record
// verifies it.
std::string evidence_of(const fs::path& source, const cuda::CudaBuild& build) {
  std::string why;
  const Json record = Json::parse(plain_file(proof_file(source), why).value_or(""), nullptr, false);
  try {
    for (const Json& lane : record.at("lanes")) {
      const auto count = [&](const char* field) { return lane.at(field).get<std::uint64_t>(); };
      if (lane.at("hash") != build.hash || build.twin.empty() || count("twin_pairs") == 0 || count("differences") > 0 ||
          count("twin_differences") > 0)
        continue;
      return cuda::evidence(cuda::TwinProof{
          record.at("device").get_ref<const std::string&>(), record.at("toolkit").get_ref<const std::string&>(),
          static_cast<double>(count("pairs")), static_cast<double>(count("twin_pairs"))});
    }
  } catch (const Json::exception&) {  // the record is missing or damaged
  }
  return cuda::evidence(build);
}

// Throws: std::runtime_error if the subject's code is not the code that a campaign ran.   recorded: that code's hash;
// an empty one accepts any code.
void expect_code(const Opened& subject, const std::string& recorded) {
  if (const std::string found = fmt::format("{:016x}", subject.code.hash); !recorded.empty() && found != recorded)
    throw std::runtime_error(fmt::format(
        "{} has changed since the campaign ran: its hash is {}, not {}; restore it, or run the campaign again",
        subject.wanted.what, found, recorded));
}

// For record(): the compiler, environment and builds of a source that a host compiler built.
Json how_built(const Opened& source, const std::vector<Built>& built) {
  Json made = {{"compiler", built.front().compiler}, {"environment", compiler_environment(source.file)}};
  for (const Built& build : built) made["builds"].push_back(build.file.stem().string());
  return made;
}

// Makes the host lanes of a CUDA source whose function is __host__ __device__. If a lane cannot be built, its evidence
// is the reason.
void add_host_lanes(Entry& entry, std::vector<Lane>& made) {
  Opened& o = entry.opened;
  const Scalar scalar = entry.builds.front().scalar;
  const std::vector<std::string> flags = host_flags(o);
  const StopSignals stops;
  try {
    if (!is_host_device(o.file, function_of(o), recipe_of(info_of(Variant::cpu), o.file), flags)) return;
  } catch (const std::runtime_error&) {  // the host's compiler cannot read the source
    return;
  }
  (scalar == Scalar::f32 ? o.description.f32 : o.description.f64) = true;
  std::vector<Built> built;
  for (const VariantInfo& row : kVariants) {
    if (row.runs_on != RunsOn::host || row.arithmetic == Arithmetic::exact) continue;
    Lane lane = lane_row(&entry.info, scalar, row.variant, 0);
    if (!runs_on_this_cpu(lane)) continue;
    try {
      const Built& build = built.emplace_back(build_source(o.file, function_of(o), recipe_of(row, o.file), flags));
      Code code{"library", build.file.string(), "", "any", o.wanted.timeout, o.wanted.memory};
      code.content = build.content;
      if (!describe(code).has(scalar))
        throw std::runtime_error("on the host, its function takes another type of number");
      add_lane(entry, made, std::move(code), std::move(lane));
    } catch (const std::runtime_error& error) {
      lane.evidence = printable(error.what());
      made.push_back(std::move(lane));
    }
  }
  if (!built.empty()) o.made["host"] = how_built(o, built);
}

// Adds the lanes of a CUDA source, which run on the device or as twins. If a lane can run in neither way, its evidence
// is the reason.
void add_cuda_lanes(Entry& entry, bool on_device, const std::string& recorded) {
  const Opened& o = entry.opened;
  std::vector<Lane> made;
  for (cuda::CudaBuild& build : cuda::build_cuda_subject(o.file, function_of(o), o.wanted.flags, cache_folder())) {
    Code code = code_of(build, o.wanted, on_device, entry.twins.emplace_back(twin_of(build)));
    Lane lane = lane_row(&entry.info, build.scalar, build.variant, 0);
    lane.evidence = on_device ? "device" : evidence_of(o.file, build);
    code.what.empty() ? made.push_back(std::move(lane)) : add_lane(entry, made, std::move(code), std::move(lane));
    entry.builds.push_back(std::move(build));
  }
  std::vector<Lane> all;
  const std::string toolkit = entry.builds.front().toolkit;
  entry.opened.made = {{"source_hash", fmt::format("{:016x}", o.hash)}, {"compiler", "NVRTC " + toolkit}};
  add_host_lanes(entry, all);
  std::move(made.begin(), made.end(), std::back_inserter(all));
  std::vector<std::string_view> variants;
  for (const cuda::CudaBuild& build : entry.builds) variants.push_back(build.ptx);
  entry.opened.code = hash_of_ptx(variants);
  expect_code(entry.opened, recorded);
  describe_info(entry, {});
  add_lanes(std::move(all));
  for (std::size_t i = 0; i < entry.builds.size(); ++i) {
    if (!entry.twins[i]) continue;
    cuda::add_foreign_twin(*find_lane(id_of(lane_name(o.wanted.name, entry.builds[i]))), entry.twins[i]->file(),
                           o.wanted.timeout);
  }
}

// Builds the source with the toolchain and starts the program once.   Throws: std::runtime_error; Stopped.
Code code_by(const Toolchain& toolchain, const Opened& subject, const std::string& kept, Built& built,
             Description& description) {
  if (const std::string why = why_not_here(toolchain); !why.empty()) throw std::runtime_error(why);
  built = subject.kind == "opencl" ? built_for_opencl(subject.file, subject.content, toolchain.run)
          : !kept.empty()          ? kept_build(kept, true)
                          : build_source(subject.file, function_of(subject), recipe_of(toolchain, subject.file),
                                         host_flags(subject));
  Code code{"program", toolchain.run, "", "any", subject.wanted.timeout, subject.wanted.memory};
  if (subject.kind == "opencl") {
    code.memory = std::max(code.memory, kDriverMemory);
    code.alone = true;
  }
  code.content = built.content;
  description = describe(code);
  return code;
}

// Adds the toolchains' lanes that the entry does not have yet. If a lane cannot be built or run here, its evidence is
// the reason.   kept: cached programs to load instead of compiling, by toolchain.
void add_toolchain_lanes(Entry& entry, const std::vector<Toolchain>& toolchains,
                         const std::map<std::string, std::string>& kept) {
  const bool published = entry.opened.kind == kPublished;
  const AlgorithmInfo* info = published ? find_published(entry.opened.wanted.name)->info : &entry.info;
  const Description& known = entry.opened.description;
  std::vector<Lane> made;
  for (const Toolchain& toolchain : toolchains) {
    const auto is_it = [&](const Entry::FromToolchain& row) { return row.toolchain.name == toolchain.name; };
    if (std::any_of(entry.from_toolchains.begin(), entry.from_toolchains.end(), is_it)) continue;
    Built built;
    Code code;
    Description description;
    std::string why_not;
    try {
      const auto found = kept.find(toolchain.name);
      code = code_by(toolchain, entry.opened, found == kept.end() ? "" : found->second, built, description);
    } catch (const std::runtime_error& error) {
      why_not = printable(error.what());
      description.f32 = published || known.f32 || entry.opened.kind == "opencl";
      description.f64 = published || known.f64;
    }
    entry.from_toolchains.push_back({toolchain, why_not.empty() ? built.file.stem().string() : "", built.compiler});
    for (const Scalar scalar : {Scalar::f32, Scalar::f64}) {
      if (!description.has(scalar)) continue;
      Lane lane = lane_row(info, scalar, Variant::toolchain, known.outside);
      lane.toolchain = toolchain.name;
      lane.evidence = why_not;
      why_not.empty() ? add_lane(entry, made, code, std::move(lane)) : made.push_back(std::move(lane));
    }
  }
  add_lanes(std::move(made));
}

// Whether a host compiler builds the source.
bool runs_on_host(const Opened& source) {
  return source.kind == "source" || (source.kind == "cuda" && (source.description.f32 || source.description.f64));
}

void open_as(const Wanted& wanted, bool on_device, const std::string& recorded,
             const std::map<std::string, std::string>& kept = {}) {
  const Opened wish = parsed(wanted);
  if (wish.kind == "hip")
    throw UsageError(fmt::format(
        "--subject {0}: HIP code is compiled, but not run; `graze toolchain hip --subject {0}={1}` lists the products "
        "that its compiler fuses",
        wanted.name, shown_path(wanted.what)));
  if (Entry* const there = find_entry(wanted.name)) {
    const bool more = wish.kind == kPublished || runs_on_host(there->opened);
    if (there->opened.hash == wish.hash && there->opened.wanted.what == wanted.what &&
        there->opened.wanted.flags == wish.wanted.flags)
      return more ? add_toolchain_lanes(*there, wanted.toolchains, kept) : void();
    throw UsageError(
        fmt::format("--subject {0}: another subject has the name {0} already; choose another", wanted.name));
  }
  for (const Lane& lane : lanes()) {
    if (lane.info->id == wanted.name && wish.kind != kPublished)
      throw UsageError(
          fmt::format("--subject {0}: a published algorithm has the name {0}; choose another", wanted.name));
  }
  Entry& entry = entries().emplace_back();
  entry.opened = wish;
  try {
    if (wish.kind == kPublished || wish.kind == "opencl") {
      expect_code(wish, recorded);
      if (wish.kind == kPublished) return add_toolchain_lanes(entry, wanted.toolchains, kept);
      describe_info(entry, {});
      return add_toolchain_lanes(entry, opencl_toolchains(function_of(wish)), kept);
    }
    Code code{wish.kind == "command" ? "command" : "library",
              wish.kind == "command" ? wanted.what.substr(kCommand.size()) : wish.file.string(),
              wish.function,
              "any",
              wanted.timeout,
              wanted.memory};
    code.content = wish.content;
    code.files = wish.code.files;
    const std::size_t slash = wish.function.find('/');
    if (wish.kind == "library" && slash != std::string::npos) {
      code.name = wish.function.substr(0, slash);
      code.scalar = wish.function.substr(slash + 1);
      if (code.scalar != "f32" && code.scalar != "f64")
        throw UsageError(fmt::format("--subject {}: expected FUNCTION/f32 or FUNCTION/f64, found '{}'", wanted.name,
                                     printable(wish.function)));
    }
    if (wish.kind == "cuda") {
      add_cuda_lanes(entry, on_device, recorded);
      return runs_on_host(entry.opened) ? add_toolchain_lanes(entry, wanted.toolchains, kept) : void();
    }
    const StopSignals stops;  // set only here, because NVRTC's compilations above cannot be stopped
    std::vector<std::pair<Variant, Code>> builds;
    std::vector<Built> built_files;
    if (wish.kind == "source") {
      for (const VariantInfo& row : kVariants) {
        if (row.runs_on != RunsOn::host || row.arithmetic == Arithmetic::exact) continue;
        Code built = code;
        built.name.clear();
        built_files.push_back(wanted.builds.empty()
                                  ? build_source(wish.file, function_of(wish), recipe_of(row, wish.file), wanted.flags)
                                  : kept_build(wanted.builds.at(built_files.size())));
        built.what = built_files.back().file;
        built.content = built_files.back().content;
        builds.emplace_back(row.variant, std::move(built));
      }
    } else {
      builds.emplace_back(Variant::cpu, std::move(code));
    }
    Lane probe{};
    std::vector<Lane> made;
    Description description;
    for (const auto& [variant, of_variant] : builds) {
      probe.variant = variant;
      if (!runs_on_this_cpu(probe)) continue;
      description = describe(of_variant);
      if (wish.kind == "command") add_description(description, wanted.name);
      if (description.f32)
        add_lane(entry, made, of_variant, lane_row(&entry.info, Scalar::f32, variant, description.outside));
    }
    for (const auto& [variant, of_variant] : builds) {
      probe.variant = variant;
      if (description.f64 && runs_on_this_cpu(probe))
        add_lane(entry, made, of_variant, lane_row(&entry.info, Scalar::f64, variant, description.outside));
    }
    if (made.empty())
      throw std::runtime_error(
          fmt::format("--subject {}: the description of {} has neither a function of floats nor one of doubles",
                      wanted.name, shown(wanted.what)));
    if (wish.kind == "source") {
      entry.opened.code = hash_of_builds(built_files);
      entry.opened.made = {{"source_hash", fmt::format("{:016x}", wish.hash)}};
      entry.opened.made.update(how_built(wish, built_files));
    }
    if (wish.kind == "command" || description.describes_itself) {  // a description can change without any file changing
      entry.opened.code.hash = fnv1a(fmt::format("{}\n{}\n{}\n{}", description.version, description.source,
                                                 description.convention, description.outside),
                                     entry.opened.code.hash);
    }
    expect_code(entry.opened, recorded);
    if (stop_requested) throw Stopped();
    entry.opened.description = description;
    describe_info(entry, description);
    add_lanes(std::move(made));
  } catch (...) {
    entries().pop_back();
    throw;
  }
  if (wish.kind == "source") add_toolchain_lanes(entry, wanted.toolchains, kept);
}

}  // namespace

Wanted parse_subject(const std::string& text) {
  const std::size_t equals = text.find('=');
  const std::string name = text.substr(0, equals);
  const auto fits = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-' || c == '.';
  };
  constexpr std::size_t kLongestName = 100;
  if (equals == text.npos || name.find_first_not_of('.') == name.npos || !std::all_of(name.begin(), name.end(), fits) ||
      name.size() > kLongestName || equals + 1 == text.size()) {
    throw UsageError(fmt::format(
        "--subject: expected NAME=WHAT with a name of at most {} letters, digits, '_', '-' and '.', found '{}'",
        kLongestName, printable(text)));
  }
  Wanted wanted{name, text.substr(equals + 1), {}};
  if (!wanted.what.starts_with(kCommand)) wanted.what = fs::absolute(wanted.what).lexically_normal().string();
  return wanted;
}

void open(const Wanted& wanted, bool on_device) { open_as(wanted, on_device, ""); }

std::vector<std::string> host_flags(const Opened& source) {
  std::vector<std::string> flags = source.wanted.flags;
  if (source.kind == "cuda")
    std::erase_if(flags, [](const std::string& flag) {
      return !flag.starts_with("-D") && !flag.starts_with("-U") && !flag.starts_with("-I");
    });
  return flags;
}

Opened named_by(const Wanted& wanted) { return parsed(wanted); }

std::string function_of(const Opened& source) { return source.function.empty() ? "intersects" : source.function; }

fs::path proof_file(const fs::path& source) { return source.string() + ".proof.json"; }

std::vector<cuda::NamedBuild> cuda_builds() {
  std::vector<cuda::NamedBuild> all;
  for (const Entry& entry : entries()) {
    for (const cuda::CudaBuild& build : entry.builds)
      all.push_back({id_of(lane_name(entry.opened.wanted.name, build)), &build});
  }
  return all;
}

const Opened* opened(std::string_view subject) {
  const Entry* const entry = find_entry(subject);
  return entry ? &entry->opened : nullptr;
}

const Toolchain* toolchain_of(const Lane& lane) {
  const Entry* const entry = lane.toolchain.empty() ? nullptr : find_entry(lane.info->id);
  if (!entry) return nullptr;
  for (const Entry::FromToolchain& row : entry->from_toolchains) {
    if (row.toolchain.name == lane.toolchain) return &row.toolchain;
  }
  return nullptr;
}

ForeignProcesses& processes_of(const Lane& lane) {
  const LaneName name = lane.lane_name();
  const Entry* const entry = find_entry(name.subject);
  if (!entry || !entry->running.contains(name.within_subject()))
    throw std::logic_error(lane.id + ": expected a lane of foreign code");
  return *entry->running.at(name.within_subject());
}

namespace {

// A toolchain build's plan, as from recorded_plan. Null for OpenCL C, which the device's driver compiles.
Json plan_of(const Opened& subject, const Toolchain& toolchain, const std::string& build) {
  if (subject.kind == "opencl") return nullptr;
  return recorded_plan(build, subject.file, function_of(subject), recipe_of(toolchain, subject.file),
                       host_flags(subject));
}

}  // namespace

Json record(const std::vector<std::string>& lanes) {
  const StopSignals stops;                     // active while compilers run
  std::map<std::string, std::string> runners;  // hashes of runners, by the command that runs builds
  Json rows;
  for (const Entry& entry : entries()) {
    const Opened& o = entry.opened;
    const auto is_of = [&](const std::string& id) { return id.starts_with(o.wanted.name + '/'); };
    Json from_toolchains;
    for (const Entry::FromToolchain& row : entry.from_toolchains) {
      if (row.build.empty() || std::none_of(lanes.begin(), lanes.end(), [&](const std::string& id) {
            return is_of(id) && parse_lane_name(id)->variant == row.toolchain.name;
          }))
        continue;
      from_toolchains.push_back(to_json(row.toolchain));
      // The plan comes before the build, so that the first difference between two records names the plan.
      if (const Json plan = plan_of(o, row.toolchain, row.build); !plan.is_null())
        from_toolchains.back()["contraction"] = plan;
      from_toolchains.back()["build"] = row.build;
      from_toolchains.back()["compiler"] = row.compiler;
      if (const std::string& run = row.toolchain.run; !run.empty() && o.kind != "opencl") {
        std::string& hash = runners[run];
        if (hash.empty()) hash = fmt::format("{:016x}", hash_of_command(run).hash);
        from_toolchains.back()["runner"] = hash;
      }
    }
    if (o.kind == kPublished ? from_toolchains.is_null() : std::none_of(lanes.begin(), lanes.end(), is_of)) continue;
    rows.push_back({{"name", o.wanted.name},
                    {"what", o.wanted.what},
                    {"flags", o.wanted.flags},
                    {"timeout", o.wanted.timeout},
                    {"memory", o.wanted.memory},
                    {"hash", fmt::format("{:016x}", o.code.hash)}});
    rows.back().update(o.made);
    if (std::none_of(lanes.begin(), lanes.end(), [&](const std::string& id) {
          const auto variant = is_of(id) ? variant_of_name(parse_lane_name(id)->variant) : std::nullopt;
          return variant && info_of(*variant).runs_on == RunsOn::host;
        }))
      rows.back().erase("host");
    if (!from_toolchains.is_null()) rows.back()["toolchains"] = from_toolchains;
    if (!o.code.not_covered.empty()) rows.back()["not_covered"] = o.code.not_covered;
  }
  return rows;
}

namespace {

// The subject of a row of record().
Wanted recorded_subject(const Json& row, const std::string& name) {
  Wanted wanted{name, row.at("what"), row.at("flags").get<std::vector<std::string>>(), row.at("timeout"),
                row.at("memory")};
  for (const Json& toolchain : row.value("toolchains", Json::array()))
    wanted.toolchains.push_back(toolchain_of_json(toolchain));
  return wanted;
}

// The toolchains' builds in a row of record(), by toolchain.
std::map<std::string, std::string> recorded_builds(const Json& row) {
  std::map<std::string, std::string> builds;
  for (const Json& toolchain : row.value("toolchains", Json::array()))
    builds[toolchain.at("name")] = toolchain.at("build");
  return builds;
}

// A toolchain's contraction plan in a row of record(); null if it has none.
Json recorded_contraction(const Json& row, const std::string& toolchain) {
  for (const Json& of : row.value("toolchains", Json::array())) {
    if (of.at("name") == toolchain) return of.value("contraction", Json());
  }
  return nullptr;
}

}  // namespace

std::vector<std::string> open_recorded(const Json& spec, bool on_device, Changed changed) {
  std::vector<std::string> differs;
  for (const Json& row : spec.value("subjects", Json::array())) {
    const std::string name = row.at("name"), hash = row.at("hash");
    const Wanted wanted = recorded_subject(row, name);
    if (!opened(name) || !wanted.toolchains.empty())
      open_as(wanted, on_device, changed == Changed::refused ? hash : "");
    if (const std::string found = fmt::format("{:016x}", opened(name)->code.hash); found != hash)
      differs.push_back(
          fmt::format("{}: its code is not the code that the campaign ran: {} then, {} now", name, hash, found));
    const auto builds_on_host = [](const Json& made) {
      return made.value("host", Json::object()).value("builds", Json());
    };
    if (const Json then = builds_on_host(row), now = builds_on_host(opened(name)->made);
        !then.is_null() && then != now) {
      const std::string what =
          fmt::format("{}: the host's compiler does not build the code that the campaign ran: {} then, {} now", name,
                      then.dump(), now.dump());
      if (changed == Changed::refused) throw std::runtime_error(what);
      differs.push_back(what);
    }
    const std::map<std::string, std::string> builds = recorded_builds(row);
    const Entry& entry = *find_entry(name);
    for (const Entry::FromToolchain& made : entry.from_toolchains) {
      const auto then = builds.find(made.toolchain.name);
      if (then == builds.end() || made.build.empty() || then->second == made.build) continue;
      std::string what = fmt::format("{}: {} does not build the code that the campaign ran: {} then, {} now", name,
                                     made.toolchain.name, then->second, made.build);
      const Json plan = plan_of(entry.opened, made.toolchain, made.build);
      if (const std::string fused = plan_difference(recorded_contraction(row, made.toolchain.name), plan);
          !fused.empty())
        what += "; " + fused;
      if (changed == Changed::refused) throw std::runtime_error(what);
      differs.push_back(what);
    }
  }
  return differs;
}

bool open_kept(const Json& row, const std::string& name) {
  Wanted wanted = recorded_subject(row, name);
  if (wanted.what == kPublished) return false;
  wanted.builds = row.value("builds", std::vector<std::string>());
  for (const bool kept : {true, false}) {
    if (!kept) wanted.builds.clear();
    if (kept && wanted.builds.empty()) continue;
    try {
      open_as(wanted, false, row.at("hash"), kept ? recorded_builds(row) : std::map<std::string, std::string>());
      return true;
    } catch (const UsageError&) {
      throw;
    } catch (const Json::exception&) {
      throw;
    } catch (const std::runtime_error&) {  // the code has changed or is missing
    } catch (const std::out_of_range&) {   // the builds are for other variants
    }
  }
  return false;
}

}  // namespace graze::subjects
