// SPDX-License-Identifier: Apache-2.0
#include "fuzz/pack/pack.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/cannot.h"
#include "core/error.h"
#include "core/fnv1a.h"
#include "core/text.h"
#include "corpus/pair_format.h"
#include "fuzz/campaign/campaign_scene.h"
#include "fuzz/campaign/checked_summary.h"
#include "fuzz/campaign/recorded.h"
#include "fuzz/campaign/result_files.h"
#include "fuzz/hunt/hunt_rounds.h"
#include "fuzz/sealed.h"
#include "subjects/portable.h"

namespace graze::fuzz {
namespace {

namespace fs = std::filesystem;

constexpr const char* kManifest = "pack.json";
constexpr int kPackFormat = 1;

std::string hash_text(const std::string& bytes) { return fmt::format("{:016x}", fnv1a(bytes)); }

// The pack's files so far, each with a different name.
class Collected {
 public:
  // Throws: std::runtime_error if a different file already has the name.
  void add(const std::string& name, std::string bytes, bool is_program = false) {
    const auto [found, is_new] = files_.try_emplace(name, PackedFile{name, is_program, bytes});
    if (!is_new && found->second.bytes != bytes)
      throw std::runtime_error(cannot("pack", name, "two files of the campaign have this name; rename one of them"));
  }
  void add_file(const std::string& name, const fs::path& file) {
    expect_file(file);
    if (!fs::exists(file)) throw std::runtime_error(cannot("pack", file, "it is missing"));
    const bool is_program = (fs::status(file).permissions() & fs::perms::owner_exec) != fs::perms::none;
    add(name, read_whole(file), is_program);
  }
  std::vector<PackedFile> files() const {
    std::vector<PackedFile> all;
    for (const auto& [unused, file] : files_) all.push_back(file);
    return all;
  }

 private:
  std::map<std::string, PackedFile> files_;
};

// The database without its two change counters, which grow when a campaign is resumed.
// Reference: SQLite's database file format, bytes 24 to 27 and 92 to 95, which must agree.
std::string without_change_counters(std::string database) {
  for (const std::size_t at : {24, 92}) {
    if (at + 4 <= database.size()) database.replace(at, 4, std::string("\0\0\0\1", 4));
  }
  return database;
}

void add_results(const fs::path& directory, const Json& summary, Collected& to) {
  const auto add = [&](const std::string& name) { to.add_file("campaign/" + name, directory / name); };
  add("summary.json");
  to.add(std::string("campaign/") + kDatabase, without_change_counters(read_whole(directory / kDatabase)));
  if (summary.at("spec").contains("hunt")) expect_rounds_told(recorded_store(directory));
  for (const char* name : {"timings.json", "failures.json", "hunt.json"}) {
    if (fs::exists(directory / name)) add(name);
  }
  for (const char* list : {"signatures", "executor_mismatches"}) {
    for (const Json& row : summary.value(list, Json::array()))
      to.add_file("campaign/" + row.at("case").get<std::string>(), case_file(directory, row));
  }
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(directory / "hunt", none)) {
    if (entry.path().extension() == ".round") add("hunt/" + entry.path().filename().string());
  }
}

// Adds the subjects' files.   Returns: {"name", "what", "flags"} for each subject.
Json add_subjects(const Json& recorded, Collected& to, Json& not_packed) {
  Json rows = Json::array();
  for (const Json& row : recorded) {
    const std::string name = row.at("name");
    if (row.contains("toolchains"))
      throw UsageError(cannot("pack", name,
                              "its toolchain lanes need compilers and emulators, which a pack cannot hold; "
                              "run a campaign without --toolchains"));
    const subjects::Opened* opened = subjects::opened(name);
    if (!opened) throw std::logic_error("expected the campaign's subjects to be open");
    const subjects::Portable portable = subjects::portable(*opened);
    for (const auto& [within, file] : portable.files) to.add_file("files/" + within, file);
    for (const std::string& sentence : portable.missing) not_packed.push_back(sentence);
    rows.push_back({{"name", name}, {"what", portable.what}, {"flags", portable.flags}});
  }
  return rows;
}

// Adds the meshes of --mesh.   Returns: their names.
Json add_meshes(const Json& spec, Collected& to) {
  Json names = Json::array();
  recorded_sources(spec);  // throws if a mesh has changed
  for (const std::string file : spec.at("mesh").at("files")) {
    names.push_back(fmt::format("mesh/{}/{}", names.size(), fs::path(file).filename().string()));
    to.add_file("files/" + names.back().get<std::string>(), file);
  }
  return names;
}

// Adds the scene and its meshes, whose names are relative to the scene's folder.   Returns: the scene's name.
std::string add_scene(const Json& recorded, Collected& to) {
  const NamedScene scene = recorded_scene(recorded);
  sources_of(scene, 0, 1, {});  // throws if a mesh has changed
  const fs::path file = scene.file;
  std::vector<fs::path> inputs(scene.scene.meshes.files.begin(), scene.scene.meshes.files.end());
  if (!scene.scene.meshes.poses.empty()) inputs.emplace_back(scene.scene.meshes.poses);
  std::ptrdiff_t most_up = 0;  // how many levels above the scene's folder a name leads
  for (fs::path& input : inputs) {
    input = input.lexically_normal();
    most_up = std::max(most_up, std::count(input.begin(), input.end(), fs::path("..")));
    if (input.is_absolute())
      throw std::runtime_error(
          cannot("pack", file,
                 fmt::format("it names {} with an absolute path; use a path relative to the scene, "
                             "and run the campaign again",
                             shown_path(input.string()))));
  }
  fs::path folder = "scene";
  for (std::ptrdiff_t up = 0; up < most_up; ++up) folder /= "folder";
  for (const fs::path& input : inputs)
    to.add_file("files/" + (folder / input).lexically_normal().string(), file.parent_path() / input);
  const std::string name = (folder / file.filename()).string();
  to.add("files/" + name, recorded.at("text"));
  return name;
}

void expect_listed(const std::vector<PackedFile>& files, const Json& manifest) {
  std::map<std::string, Json> listed;
  for (const Json& row : manifest.at("files")) {
    if (!listed.emplace(row.at("name").get<std::string>(), row).second)
      throw std::runtime_error(fmt::format("{} lists {} twice", kManifest, shown_path(row["name"].get<std::string>())));
  }
  for (const PackedFile& file : files) {
    if (file.name == kManifest) continue;
    const auto found = listed.find(file.name);
    if (found == listed.end()) throw std::runtime_error(fmt::format("{} does not list {}", kManifest, file.name));
    if (found->second.at("hash") != hash_text(file.bytes))
      throw std::runtime_error(file.name + " does not match its hash");
    if (found->second.at("bytes") != file.bytes.size())
      throw std::runtime_error(
          fmt::format("{} has {} bytes, not those that {} lists", file.name, file.bytes.size(), kManifest));
    listed.erase(found);
  }
  if (!listed.empty()) throw std::runtime_error("it lacks " + shown_path(listed.begin()->first));
}

// Throws: std::runtime_error unless `what` names a file in the pack or is a command.
void expect_in_pack(const std::vector<PackedFile>& files, const std::string& what) {
  const auto is_there = [&](const PackedFile& file) {
    const std::string name = "files/" + what;
    return name == file.name || name.starts_with(file.name + ':');
  };
  if (!what.starts_with("cmd:") && std::none_of(files.begin(), files.end(), is_there))
    throw std::runtime_error(shown_path(what) + " is not in the pack");
}

}  // namespace

Pack pack_campaign(const fs::path& directory) {
  const Json summary = checked_summary(directory);
  const Json& spec = summary.at("spec");
  if (!has_database(directory) || !summary.at("complete").get<bool>())
    throw std::runtime_error(cannot("pack", directory,
                                    !has_database(directory) ? std::string("its campaign.sqlite is missing")
                                                             : "the campaign is not complete; finish it: " +
                                                                   command_of(spec, {}, directory, summary)));
  if (fs::exists((directory / kDatabase).string() + "-wal"))
    throw std::runtime_error(
        cannot("pack", directory, "its last run was killed; finish it: " + command_of(spec, {}, directory, summary)));
  Collected files;
  add_results(directory, summary, files);
  Json inputs = Json::object(), not_packed = Json::array();
  if (spec.contains("subjects")) inputs["subjects"] = add_subjects(spec["subjects"], files, not_packed);
  if (spec.contains("mesh")) inputs["mesh"] = add_meshes(spec, files);
  if (spec.contains("scene")) inputs["scene"] = add_scene(spec["scene"], files);
  Pack pack{files.files(), {{"graze_pack", kPackFormat}}};
  for (const char* key : {"version", "commit", "compiler", "cuda"})
    pack.manifest["build"][key] = summary.at("build").value(key, Json());
  pack.manifest["inputs"] = inputs;
  pack.manifest["command"] = command_of(spec_of_pack(spec, pack.manifest), {}, "../again", summary);
  pack.manifest["not_packed"] = not_packed;
  pack.manifest["files"] = Json::array();
  for (const PackedFile& file : pack.files)
    pack.manifest["files"].push_back(
        {{"name", file.name}, {"bytes", file.bytes.size()}, {"hash", hash_text(file.bytes)}});
  pack.files.push_back({kManifest, false, sealed(pack.manifest).dump(1) + "\n"});
  return pack;
}

Pack read_pack(const fs::path& file) {
  Pack pack{read_archive(file), {}};
  try {
    const auto found = std::find_if(pack.files.begin(), pack.files.end(),
                                    [](const PackedFile& packed) { return packed.name == kManifest; });
    if (found == pack.files.end()) throw std::runtime_error("it has no pack.json");
    Json manifest = parse_shallow(found->bytes);
    if (!manifest.is_object() || manifest.value("graze_pack", Json()) != kPackFormat)
      throw std::runtime_error(fmt::format("its pack.json does not have format {}", kPackFormat));
    manifest.erase("checksum");
    if (sealed(manifest).dump(1) + "\n" != found->bytes) throw std::runtime_error("its pack.json is damaged");
    for (const PackedFile& packed : pack.files) {
      if (packed.name != kManifest && !packed.name.starts_with("campaign/") && !packed.name.starts_with("files/"))
        throw std::runtime_error("it has a file outside campaign/ and files/: " + shown_path(packed.name));
    }
    expect_listed(pack.files, manifest);
    const Json& inputs = manifest.at("inputs");
    for (const Json& row : inputs.value("subjects", Json::array())) expect_in_pack(pack.files, row.at("what"));
    for (const Json& name : inputs.value("mesh", Json::array())) expect_in_pack(pack.files, name);
    if (inputs.contains("scene")) expect_in_pack(pack.files, inputs["scene"]);
    for (const Json& sentence : manifest.at("not_packed")) sentence.get_ref<const std::string&>();
    pack.manifest = std::move(manifest);
  } catch (const Json::exception&) {
    throw corpus::FormatError(cannot("use", file, "its pack.json was not written by Graze"));
  } catch (const std::runtime_error& error) {
    throw corpus::FormatError(cannot("use", file, std::string(error.what()) + "; get the pack from its source again"));
  }
  return pack;
}

Json spec_of_pack(Json spec, const Json& manifest) {
  const Json& inputs = manifest.at("inputs");
  const auto refuse = [](const char* what) {
    throw std::runtime_error(fmt::format("the pack's {} are not those of its campaign", what));
  };
  const Json subjects = inputs.value("subjects", Json::array());
  if (subjects.size() != spec.value("subjects", Json::array()).size()) refuse("subjects");
  for (std::size_t s = 0; s < subjects.size(); ++s) {
    Json& row = spec["subjects"][s];
    if (row.at("name") != subjects[s].at("name")) refuse("subjects");
    row["what"] = subjects[s].at("what").get<std::string>();
    row["flags"] = subjects[s].at("flags").get<std::vector<std::string>>();
    row.erase("environment");  // a pack does not choose this machine's compiler
  }
  const Json mesh = inputs.value("mesh", Json::array());
  if (mesh.size() != (spec.contains("mesh") ? spec["mesh"].at("files").size() : 0)) refuse("meshes");
  if (!mesh.empty()) spec["mesh"]["files"] = mesh;
  if (inputs.contains("scene") != spec.contains("scene")) refuse("scenes");
  if (spec.contains("scene")) spec["scene"]["file"] = inputs["scene"].get<std::string>();
  return spec;
}

}  // namespace graze::fuzz
