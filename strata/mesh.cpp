// SPDX-License-Identifier: Apache-2.0
// Pairs from real input: reads float32 triangles from files, and pairs those whose closed boxes overlap.
#include "strata/mesh.h"

#include <CGAL/box_intersection_d.h>

#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <span>
#include <string>

#include "core/cannot.h"
#include "core/fnv1a.h"
#include "core/plain_file.h"
#include "core/text.h"
#include "strata/mesh_box.h"
#include "strata/mesh_readers/lines.h"

namespace graze::strata {
namespace {

using Triangle = std::array<Vec3<float>, 3>;

// A limit on candidate pairs, without which a mesh whose triangles all overlap would fill the memory.
constexpr std::size_t kMostCandidates = std::size_t{1} << 28;  // 2 GiB of indices

std::string read_bytes(const std::filesystem::path& file) {
  std::string why;
  const auto memory =
      static_cast<std::size_t>(sysconf(_SC_PHYS_PAGES)) * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  if (auto bytes = plain_file(file, why, memory)) return std::move(*bytes);
  if (why.starts_with("it is larger")) why += ", the memory of this machine";
  throw std::runtime_error(cannot("read", file, why));
}

struct MeshFormat {
  std::string_view extension, name;
  Soup (*read)(const MeshBytes& file);
};
constexpr MeshFormat kFormats[] = {
#define GRAZE_MESH_FORMAT(extension, name) {"." #extension, name, read_##extension},
#include "strata/mesh_readers/formats.inc"
#undef GRAZE_MESH_FORMAT
};

// Null if no mesh format has the extension.
const MeshFormat* format_of(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const MeshFormat& format : kFormats) {
    if (extension == format.extension) return &format;
  }
  return nullptr;
}

// ".off, .obj, .stl or .ply"
std::string listed(std::string_view MeshFormat::*column) {
  std::string list;
  for (const MeshFormat& format : kFormats) {
    const bool last = &format + 1 == std::end(kFormats);
    list += (list.empty() ? "" : last ? " or " : ", ") + std::string(format.*column);
  }
  return list;
}

Soup read_soup(const std::filesystem::path& file, std::string_view bytes, Coordinates coordinates) {
  const MeshBytes mesh{file.string(), bytes, coordinates};
  if (const MeshFormat* format = format_of(file)) return format->read(mesh);
  const std::string extension = file.extension().string();
  fail(mesh.name, "a file with the extension " + listed(&MeshFormat::extension),
       extension.empty() ? "no extension" : extension);
}

void add_rounding(MeshPairs& pairs, const Rounding& rounding, const std::filesystem::path& file) {
  pairs.rounding += rounding;
  for (std::string& note : rounding_note(file.string(), rounding)) pairs.notes.push_back(std::move(note));
  for (std::string& note : doubles_note(file.string(), rounding)) pairs.notes_of_doubles.push_back(std::move(note));
}

// How many fans fold over: some triangle's normal points against the sum of the fan's normals, so the face is not
// convex. The test rounds to double, so it may miss a fold that is narrower than the rounding error.
std::size_t folded_fans(const Soup& soup) {
  const auto normal = [&](const std::array<std::uint32_t, 3>& triangle) {
    const Vec3<double>& corner = soup.in_doubles[triangle[0]];
    return cross(soup.in_doubles[triangle[1]] - corner, soup.in_doubles[triangle[2]] - corner);
  };
  return static_cast<std::size_t>(std::count_if(soup.fans.begin(), soup.fans.end(), [&](const auto& fan) {
    const auto triangles = std::span(soup.triangles).subspan(fan[0], fan[1] - fan[0]);
    Vec3<double> sum{0, 0, 0};
    for (const auto& triangle : triangles) sum = sum + normal(triangle);
    return std::any_of(triangles.begin(), triangles.end(), [&](const auto& t) { return dot(normal(t), sum) < 0; });
  }));
}

void add_note(MeshPairs& pairs, const std::filesystem::path& file, const std::string& what) {
  pairs.notes.push_back(printable(file.string()) + ": " + what);
  pairs.notes_of_doubles.push_back(pairs.notes.back());
}

// Adds the file's triangles, and hashes its bytes.
void add_mesh(MeshPairs& pairs, const std::filesystem::path& file, Coordinates coordinates = Coordinates::finite) {
  const std::string bytes = read_bytes(file);
  pairs.content_hash = fnv1a(bytes, pairs.content_hash);
  Soup soup = read_soup(file, bytes, coordinates);
  if (soup.triangles.empty()) throw std::runtime_error("there is no triangle in " + file.string());
  const std::size_t before = pairs.triangles.size();
  for (const auto& [i, j, k] : soup.triangles)
    pairs.triangles.push_back({soup.vertices[i], soup.vertices[j], soup.vertices[k]});
  if (soup.rounding.rounded > 0 || !pairs.in_doubles.empty()) {
    for (std::size_t t = pairs.in_doubles.size(); t < before; ++t)  // earlier files' coordinates are all float32
      pairs.in_doubles.push_back(in_doubles(pairs.triangles[t]));
    for (const auto& [i, j, k] : soup.triangles)
      pairs.in_doubles.push_back({soup.in_doubles[i], soup.in_doubles[j], soup.in_doubles[k]});
  }
  if (pairs.triangles.size() > std::numeric_limits<std::uint32_t>::max())
    throw std::runtime_error(cannot("use", file, "there are 2^32 triangles or more"));
  std::string skipped;
  for (const auto& [what, count] : soup.skipped)
    skipped += (skipped.empty() ? "" : ", ") + std::to_string(count) + ' ' + what;
  if (!skipped.empty())
    add_note(pairs, file, std::to_string(soup.triangles.size()) + " triangles; not used: " + skipped);
  if (const std::size_t folded = folded_fans(soup); folded > 0)
    add_note(pairs, file,
             std::to_string(folded) + " of " + std::to_string(soup.fans.size()) +
                 " faces with more than three vertices are not convex, and their triangles overlap; cut them into "
                 "triangles before Graze reads them");
  add_rounding(pairs, soup.rounding, file);
}

using Pose = std::array<double, 12>;

constexpr std::size_t kMostTriangles = std::size_t{1} << 26;  // limit over all poses: 2.25 GiB

// Reads the poses, and hashes the file's bytes.
std::vector<Pose> read_poses(const std::filesystem::path& file, std::uint64_t& hash) {
  std::string bytes = read_bytes(file);
  hash = fnv1a(bytes, hash);
  std::replace(bytes.begin(), bytes.end(), ',', ' ');
  Lines lines({file.string(), bytes}, '#');
  std::vector<Pose> poses;
  while (lines.next()) {
    Pose pose;
    for (std::size_t i = 0; i < pose.size(); ++i) {
      const std::string expected = "12 numbers, the rows of a matrix (R | t)";
      pose[i] = lines.number(i, expected);
      if (!std::isfinite(pose[i])) lines.fail_at(i, expected);
    }
    if (lines.words().size() > pose.size()) lines.fail_at(pose.size(), "the end of the line after 12 numbers");
    poses.push_back(pose);
  }
  if (poses.empty()) throw std::runtime_error("there is no pose in " + file.string());
  return poses;
}

Vec3<float> moved(const Pose& m, const Vec3<float>& v, Rounding& rounding) {
  float to[3];
  for (std::size_t i = 0; i < 3; ++i) {
    const double x = m[4 * i] * static_cast<double>(v.x), y = m[4 * i + 1] * static_cast<double>(v.y),
                 z = m[4 * i + 2] * static_cast<double>(v.z);
    const double sum = x + y + z + m[4 * i + 3];
    to[i] = static_cast<float>(sum);
    rounding.add(sum, to[i], 0x1p-50 * (std::abs(x) + std::abs(y) + std::abs(z) + std::abs(m[4 * i + 3])));
  }
  return {to[0], to[1], to[2]};
}

// Replaces the mesh with one body for each pose.   Returns: for each body, the index after its last triangle.
std::vector<std::size_t> put_poses(MeshPairs& pairs, const std::filesystem::path& file,
                                   const std::vector<Pose>& poses) {
  const std::vector<Triangle> mesh = std::move(pairs.triangles);
  if (poses.size() > kMostTriangles / mesh.size())
    throw std::runtime_error(cannot("use", file,
                                    std::to_string(poses.size()) + " poses of " + std::to_string(mesh.size()) +
                                        " triangles are more than 2^26 triangles"));
  pairs.triangles.clear();
  pairs.in_doubles.clear();  // poses move the triangles as stored in float32
  std::vector<std::size_t> ends;
  Rounding rounding;
  for (const Pose& pose : poses) {
    for (const Triangle& t : mesh) {
      const auto vertex = [&](std::size_t i) { return moved(pose, t[i], rounding); };
      pairs.triangles.push_back({vertex(0), vertex(1), vertex(2)});
      for (const Vec3<float>& v : pairs.triangles.back()) {
        if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z))
          throw std::runtime_error(cannot(
              "use", file, "pose " + std::to_string(ends.size() + 1) + " moves a vertex beyond the range of float32"));
      }
    }
    ends.push_back(pairs.triangles.size());
  }
  add_rounding(pairs, rounding, file);
  return ends;
}

// Finds the candidate pairs: within the body if there is only one, otherwise between bodies.
void pair_up(MeshPairs& result, const std::vector<std::size_t>& ends, const std::filesystem::path& file) {
  const auto add = [&](const Box& p, const Box& q) {
    if (result.candidates.size() == kMostCandidates) {
      throw std::runtime_error(cannot("use", file, "more than 2^28 pairs of triangles have boxes that overlap"));
    }
    result.candidates.push_back(std::minmax({p.info(), q.info()}));
  };
  std::vector<Box> boxes = boxes_of(result.triangles, 0, ends[0]);
  if (ends.size() == 1) CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), add);
  // Pairs each body with all bodies before it.
  for (std::size_t body = 1; body < ends.size(); ++body) {
    std::vector<Box> others = boxes_of(result.triangles, ends[body - 1], ends[body]);
    CGAL::box_intersection_d(boxes.begin(), boxes.end(), others.begin(), others.end(), add);
    boxes.insert(boxes.end(), others.begin(), others.end());
  }
  std::sort(result.candidates.begin(), result.candidates.end());
}

}  // namespace

std::array<Vec3<double>, 3> in_doubles(const Triangle& t) {
  const auto wide = [](const Vec3<float>& v) { return Vec3<double>{v.x, v.y, v.z}; };
  return {wide(t[0]), wide(t[1]), wide(t[2])};
}

std::vector<std::array<Vec3<double>, 3>> MeshPairs::triangles_in_doubles() const {
  if (!in_doubles.empty()) return in_doubles;
  std::vector<std::array<Vec3<double>, 3>> result;
  for (const Triangle& triangle : triangles) result.push_back(strata::in_doubles(triangle));
  return result;
}

Pair MeshPairs::pair(std::size_t index) const {
  const Triangle& a = triangles[candidates[index].first];
  const Triangle& b = triangles[candidates[index].second];
  return {{a[0], a[1], a[2]}, {b[0], b[1], b[2]}};
}

DoublePair MeshPairs::double_pair(std::size_t index) const {
  if (in_doubles.empty()) return graze::in_doubles(pair(index));
  const std::array<Vec3<double>, 3>&a = in_doubles[candidates[index].first], &b = in_doubles[candidates[index].second];
  return {{a[0], a[1], a[2]}, {b[0], b[1], b[2]}};
}

std::vector<PairSource> mesh_sources(const std::shared_ptr<const MeshPairs>& mesh, PairTypes types) {
  std::vector<PairSource> sources;
  if (types != PairTypes::f64)
    sources.push_back({"mesh", mesh->size(), [mesh](std::uint64_t index) { return mesh->pair(index); }});
  if (types != PairTypes::f32) {
    sources.push_back({"mesh" + std::string(kInDoubles), mesh->size(), nullptr});
    sources.back().double_pair = [mesh](std::uint64_t index) { return mesh->double_pair(index); };
  }
  return sources;
}

MeshPairs read_bodies(const std::vector<std::filesystem::path>& files, const std::filesystem::path& poses) {
  MeshPairs result;
  result.content_hash = fnv1a("");
  std::vector<std::size_t> ends;
  for (const std::filesystem::path& file : files) {
    add_mesh(result, file);
    ends.push_back(result.triangles.size());
  }
  if (!poses.empty()) ends = put_poses(result, poses, read_poses(poses, result.content_hash));
  pair_up(result, ends, files[0]);
  if (result.candidates.empty())
    throw std::runtime_error(cannot("draw pairs from", files[0], "no two triangles have boxes that overlap"));
  return result;
}

MeshPairs read_triangles(const std::filesystem::path& file, Coordinates coordinates) {
  MeshPairs result;
  result.content_hash = fnv1a("");
  add_mesh(result, file, coordinates);
  return result;
}

bool is_mesh(const std::filesystem::path& file) { return format_of(file) != nullptr; }

std::string mesh_formats() { return listed(&MeshFormat::name); }

}  // namespace graze::strata
