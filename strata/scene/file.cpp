// SPDX-License-Identifier: Apache-2.0
#include "strata/scene/file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/cannot.h"
#include "core/fnv1a.h"
#include "core/plain_file.h"
#include "core/text.h"
#include "core/toml.h"
#include "strata/mesh_readers/soup.h"
#include "strata/scene/envelope.h"

namespace graze::strata {
namespace {

constexpr std::uintmax_t kMostBytes = 1 << 20;
constexpr double kMostCoordinate = 0x1p126;
constexpr double kLeastUlps = 8;         // keeps rounding from turning all triangles into points
constexpr double kLeastAspect = 1.1547;  // an equilateral triangle's: 2 / sqrt(3), to five digits

bool is_control(char c) { return static_cast<unsigned char>(c) < ' ' || c == '\x7f'; }

// The text as a TOML string. Bytes beyond ASCII are kept, because they are UTF-8.
std::string toml_string(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (is_control(c)) {
      result += fmt::format("\\u{:04x}", static_cast<unsigned>(c));
      continue;
    }
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + '"';
}

class Reader {
 public:
  Reader(const std::string& name, const toml::table& root) : name_(name), root_(root) {}

  SceneFile scene() {
    keys(root_, "a scene", {"units", "coordinates", "extent", "edges", "aspect", "grid", "mix", "margins", "meshes"});
    SceneFile scene;
    if (const toml::node* node = root_.get("units")) {
      scene.units = text(*node);
      if (!is_units(scene.units)) fail(*node, "units of " + kUnits, shown(scene.units));
    }
    if (const toml::node* node = root_.get("coordinates")) {
      const auto type = node->value_exact<std::string>();
      if (type != "f32" && type != "f64") fail(*node, "\"f32\" or \"f64\"", found_text(*node));
      scene.in_doubles = type == "f64";
    }
    read_extent(scene);
    read_sizes(scene);
    if (const toml::node* node = root_.get("grid")) read_grid(*node, scene);
    if (const toml::node* node = root_.get("mix")) read_mix(*node, scene);
    if (const toml::node* node = root_.get("margins")) read_margins(*node, scene);
    if (const toml::node* node = root_.get("meshes")) read_meshes(*node, scene);
    return scene;
  }

 private:
  [[noreturn]] void fail(const toml::node& at, const std::string& expected, const std::string& found) const {
    strata::fail(fmt::format("{}:{}", name_, at.source().begin.line), expected, found);
  }

  // Throws: an error for a key that is not in `known`.
  void keys(const toml::table& table, const std::string& what, const std::vector<std::string>& known) const {
    for (const auto& [key, value] : table) {
      const std::string word(key.str());
      if (std::find(known.begin(), known.end(), word) != known.end()) continue;
      strata::fail(fmt::format("{}:{}", name_, key.source().begin.line),
                   fmt::format("a key of {}: {}", what, fmt::join(known, ", ")),
                   shown(word) + did_you_mean(word, known));
    }
  }

  const toml::table& table(const toml::node& node, const std::string& what) const {
    if (!node.is_table()) fail(node, what, found_text(node));
    return *node.as_table();
  }

  std::string text(const toml::node& node) const {
    const auto value = node.value_exact<std::string>();
    if (!value || value->empty()) fail(node, "a string that is not empty", found_text(node));
    return *value;
  }

  double number(const toml::node& node, double low, double high) const {
    const std::optional<double> value = node.is_number() ? node.value<double>() : std::nullopt;
    if (!value || !(low <= *value && *value <= high))
      fail(node, fmt::format("a number from {} to {}", low, high), found_text(node));
    return *value;
  }

  int whole(const toml::node& node, int low, int high) const {
    const auto value = node.value_exact<std::int64_t>();
    if (!value || *value < low || *value > high)
      fail(node, fmt::format("a whole number from {} to {}", low, high), found_text(node));
    return static_cast<int>(*value);
  }

  std::array<double, 2> interval(const toml::node& node) const {
    const toml::array* ends = node.as_array();
    if (!ends || ends->size() != 2) fail(node, "[least, greatest] coordinate", found_text(node));
    const double low = number(*ends->get(0), -kMostCoordinate, kMostCoordinate);
    const double high = number(*ends->get(1), -kMostCoordinate, kMostCoordinate);
    if (low > high) fail(node, "the least coordinate, then the greatest", fmt::format("{}, then {}", low, high));
    return {low, high};
  }

  void read_extent(SceneFile& scene) {
    const toml::node* node = root_.get("extent");
    if (!node) strata::fail(name_ + ":1", "extent = [[least, greatest], …] by axis", "no extent");
    const toml::array* axes = node->as_array();
    const std::string shape = "three intervals [least, greatest], for x, y and z, or one for all";
    if (!axes) fail(*node, shape, found_text(*node));
    if (axes->size() == 2 && axes->get(0)->is_number()) {
      scene.extent.fill(interval(*node));
    } else {
      if (axes->size() != 3) fail(*node, shape, found_text(*node));
      for (std::size_t axis = 0; axis < 3; ++axis) scene.extent[axis] = interval(*axes->get(axis));
    }
    double squares = 0;
    for (const auto& [low, high] : scene.extent) {
      const double size = as_stored(scene, high) - as_stored(scene, low);
      squares += size * size;
      largest_ = std::max({largest_, std::fabs(low), std::fabs(high)});
    }
    diagonal_ = std::sqrt(squares);
    if (diagonal_ == 0) fail(*node, "an extent that is not a single point", "a point");
  }

  std::vector<double> quantiles(const toml::node& node, double low, double high) const {
    std::vector<double> values;
    if (node.is_number()) return {number(node, low, high)};
    const toml::array* array = node.as_array();
    const std::size_t count = array ? array->size() : 0;
    if (count == 0 || count > 33 || (count != 1 && 32 % (count - 1) != 0))
      fail(node, "a number, or 1, 2, 3, 5, 9, 17 or 33 of them, from least to greatest", found_text(node));
    for (const toml::node& value : *array) {
      values.push_back(number(value, low, high));
      if (values.size() > 1 && values.back() < values[values.size() - 2])
        fail(value, fmt::format("a number of at least {}", values[values.size() - 2]), found_text(value));
    }
    return values;
  }

  void read_sizes(SceneFile& scene) {
    const toml::node* edges = root_.get("edges");
    if (!edges) strata::fail(name_ + ":1", "edges = [shortest, longest]", "no edges");
    scene.edges = quantiles(*edges, 0x1p-149, 2 * kMostCoordinate);
    if (scene.edges.back() > diagonal_ * 1.00001)
      fail(*edges, fmt::format("edges of at most {:.6g}, the diagonal of the extent", diagonal_),
           fmt::format("{}", scene.edges.back()));
    const double ulp = ulp_of(scene, largest_);
    if (scene.edges.back() < kLeastUlps * ulp)
      fail(
          *edges,
          fmt::format("a longest edge of at least {}, {} ulps of the largest coordinate", kLeastUlps * ulp, kLeastUlps),
          fmt::format("{}", scene.edges.back()));
    if (const toml::node* node = root_.get("aspect")) scene.aspect = quantiles(*node, kLeastAspect, 1e12);
  }

  void read_grid(const toml::node& node, SceneFile& scene) {
    const std::string shape = "{ power_of_two = k } or { decimals = n }";
    const toml::table& grid = table(node, shape);
    keys(grid, "a grid", {"power_of_two", "decimals"});
    if (grid.size() != 1) fail(node, shape, fmt::format("{} keys", grid.size()));
    const bool decimal = grid.contains("decimals");
    const toml::node& places = grid.begin()->second;
    scene.grid = GridSpec{decimal, decimal ? whole(places, 0, 15) : whole(places, -149, 126)};
    // Grid points' indices must be exact in double, with room to spare. The extent must contain several grid points.
    const double step = decimal ? std::pow(10.0, -scene.grid->places) : std::ldexp(1.0, scene.grid->places);
    for (const auto& [low, high] : scene.extent) {
      const double steps = std::max(std::fabs(low), std::fabs(high)) / step;
      if (steps > 0x1p48)
        fail(node, "a grid of at most 2^48 steps from the origin to the ends of the extent",
             fmt::format("{:.3g}", steps));
    }
    const Scene numbers = resolved(scene);
    bool several = false;
    for (int axis = 0; axis < 3; ++axis) {
      const double first = component(numbers.low, axis), last = component(numbers.high, axis);
      if (first > last) fail(node, "a grid point on each axis of the extent", fmt::format("none in {}", "xyz"[axis]));
      several = several || first < last;
    }
    if (!several) fail(node, "a grid with several points in the extent", "one");
    if (scene.edges.back() < step)
      fail(node, fmt::format("a step of at most {}, the longest edge", scene.edges.back()), fmt::format("{}", step));
  }

  void read_mix(const toml::node& node, SceneFile& scene) {
    const toml::table& mix = table(node, "a table of shares");
    keys(mix, "the mix", {kKindIds.begin(), kKindIds.end()});
    double all = 0;
    for (std::size_t kind = 0; kind < kKinds; ++kind) {
      const toml::node* share = mix.get(kKindIds[kind]);
      scene.mix[kind] = share ? number(*share, 0, 1) : 0;
      all += scene.mix[kind];
    }
    if (all == 0) fail(node, "a share above 0", "none");
  }

  void read_margins(const toml::node& node, SceneFile& scene) {
    const toml::table& margins = table(node, "a table of shares");
    std::vector<std::string> names;
    for (int b = -kBucketMost; b <= kBucketMost; ++b) names.push_back(name_of_bucket(static_cast<Bucket>(b)));
    for (const auto& [key, share] : margins) {
      const auto name = std::find(names.begin(), names.end(), key.str());
      if (name == names.end())
        strata::fail(fmt::format("{}:{}", name_, key.source().begin.line),
                     "a margin: \"0\", \"+2^5\" (ulps apart) or \"-2^5\" (ulps deep)",
                     shown(key.str()) + did_you_mean(key.str(), names));
      scene.margins[static_cast<Bucket>(name - names.begin() - kBucketMost)] = number(share, 0, 1);
    }
  }

  void read_meshes(const toml::node& node, SceneFile& scene) {
    const toml::table& meshes = table(node, "a table of files");
    keys(meshes, "the meshes", {"files", "poses", "content"});
    const toml::node *files = meshes.get("files"), *content = meshes.get("content");
    if (!files || !files->is_array() || files->as_array()->empty())
      fail(node, "files = [\"NAME\", …]", files ? found_text(*files) : "no files");
    for (const toml::node& file : *files->as_array()) scene.meshes.files.push_back(text(file));
    if (const toml::node* poses = meshes.get("poses")) scene.meshes.poses = text(*poses);
    if (!scene.meshes.poses.empty() && scene.meshes.files.size() != 1)
      fail(node, "one file if there are poses", found_text(*files));
    const std::string hash = content ? text(*content) : "";
    if (!is_hash(hash))
      fail(content ? *content : node, "content: 16 hexadecimal digits, as `graze scene` writes them",
           content ? shown(hash) : "none");
    scene.meshes.content = std::stoull(hash, nullptr, 16);
  }

  const std::string& name_;
  const toml::table& root_;
  double diagonal_ = 0, largest_ = 0;  // diagonal of the extent; largest magnitude of its coordinates
};

std::string list_of(const std::vector<double>& values) { return fmt::format("[{}]", fmt::join(values, ", ")); }

}  // namespace

SceneFile parse_scene(const std::string& name, std::string_view text) {
  if (text.size() > kMostBytes)
    fail(name, fmt::format("a scene of at most {} bytes", kMostBytes), std::to_string(text.size()));
  const toml::parse_result parsed = toml::parse(text);
  if (!parsed) {
    const toml::parse_error& error = parsed.error();
    fail(fmt::format("{}:{}", name, error.source().begin.line), "TOML", printable(error.description()));
  }
  return Reader(name, parsed.table()).scene();
}

SceneFile read_scene(const std::filesystem::path& file) {
  std::string why;
  if (const auto text = plain_file(file, why)) return parse_scene(file.string(), *text);
  throw std::runtime_error(cannot("read", file, why));
}

bool is_units(std::string_view text) { return text.size() <= 32 && std::none_of(text.begin(), text.end(), is_control); }

std::string scene_text(const SceneFile& scene) {
  std::string text = fmt::format("units = {}\n{}# Least and greatest coordinate of x, y and z.\nextent = [",
                                 toml_string(scene.units), scene.in_doubles ? "coordinates = \"f64\"\n" : "");
  for (std::size_t axis = 0; axis < 3; ++axis)
    text += fmt::format("{}[{}, {}]", axis > 0 ? ", " : "", scene.extent[axis][0], scene.extent[axis][1]);
  text += "]\n# Longest edge of a triangle, and that edge over the height on it: quantiles, from least to greatest.\n";
  text += fmt::format("edges = {}\naspect = {}\n", list_of(scene.edges), list_of(scene.aspect));
  if (scene.grid) {
    text += fmt::format("# All coordinates {}.\ngrid = {{ {} = {} }}\n",
                        scene.grid->decimal ? "have this many decimals" : "are multiples of this power of two",
                        scene.grid->decimal ? "decimals" : "power_of_two", scene.grid->places);
  }
  text += "\n# Shares of the pairs whose boxes overlap; strata are drawn in these shares.\n[mix]\n";
  for (std::size_t kind = 0; kind < kKinds; ++kind) text += fmt::format("{} = {}\n", kKindIds[kind], scene.mix[kind]);
  if (!scene.margins.empty()) {
    text +=
        "\n# Their margins, in ulps of the pair's largest coordinate: + apart, - deep; for information, not "
        "used to draw.\n[margins]\n";
    for (const auto& [bucket, share] : scene.margins)
      text += fmt::format("\"{}\" = {}\n", name_of_bucket(bucket), share);
  }
  if (!scene.meshes.files.empty()) {
    text +=
        "\n# The pairs of these meshes are drawn too: as they are, moved by ulps, and moved rigidly. Paths are relative"
        " to this file's folder.\n[meshes]\nfiles = [";
    for (std::size_t i = 0; i < scene.meshes.files.size(); ++i)
      text += (i > 0 ? ", " : "") + toml_string(scene.meshes.files[i]);
    text += "]\n";
    if (!scene.meshes.poses.empty()) text += fmt::format("poses = {}\n", toml_string(scene.meshes.poses));
    text += fmt::format("content = \"{:016x}\"\n", scene.meshes.content);
  }
  return text;
}

std::string scene_name(const std::string& file, const SceneFile& scene) {
  return fmt::format("{}#{:016x}", file, fnv1a(scene_text(scene)));
}

}  // namespace graze::strata
