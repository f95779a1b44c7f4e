// SPDX-License-Identifier: Apache-2.0
#include "reports/ulp_map_picture.h"

#include <fmt/format.h>
#include <png.h>
#include <stb/stb_easy_font.h>

#include <algorithm>
#include <boost/archive/iterators/base64_from_binary.hpp>
#include <boost/archive/iterators/transform_width.hpp>
#include <stdexcept>

#include "core/text.h"
#include "reports/terminal.h"

namespace graze::reports {
namespace {

// One colour for each kind of cell, in order. Ink and paper come before the colours of failing foreign code. Correct
// verdicts are grey. Wrong verdicts are vermilion and blue from Okabe and Ito's palette; these also differ
// in lightness.
constexpr std::uint8_t kPalette[][3] = {{0xee, 0xee, 0xee}, {0xaa, 0xaa, 0xaa}, {0xd5, 0x5e, 0x00}, {0x00, 0x72, 0xb2},
                                        {0xf0, 0xe4, 0x42}, {0xcc, 0x79, 0xa7}, {0x00, 0x00, 0x00}, {0xff, 0xff, 0xff},
                                        {0x00, 0x9e, 0x73}, {0x56, 0xb4, 0xe9}, {0xe6, 0x9f, 0x00}};
constexpr std::uint8_t kInk = 6, kPaper = 7;
constexpr const char* kCellNames[] = {"disjoint",   "intersects", "false positive", "false negative", "declined",
                                      "not finite", "crashed",    "timed out",      "unstable"};

constexpr std::uint8_t colour_of(std::size_t kind) { return static_cast<std::uint8_t>(kind < kInk ? kind : kind + 2); }

constexpr int kZoom = 2;  // zoom factor of a sheet's pixels and letters
constexpr int kMargin = 16;
constexpr int kLine = 24;  // height of a line of text
constexpr int kSide = kZoom * analysis::kMapSize;
constexpr int kLanesARow = 4;
constexpr int kMapCells = analysis::kMapSize * analysis::kMapSize;

struct Image {
  int width, height;
  std::vector<std::uint8_t> colours;  // indices into kPalette

  Image(int w, int h, std::uint8_t colour) : width(w), height(h), colours(static_cast<std::size_t>(w * h), colour) {}

  void fill(int left, int top, int w, int h, std::uint8_t colour) {
    for (int y = std::max(top, 0); y < std::min(top + h, height); ++y) {
      for (int x = std::max(left, 0); x < std::min(left + w, width); ++x)
        colours[static_cast<std::size_t>(y * width + x)] = colour;
    }
  }

  void write(int left, int top, std::string text) {
    struct Corner {  // stb_easy_font's layout: four corners for each quad, clockwise from the upper left
      float x, y, z;
      std::uint8_t colour[4];
    };
    std::vector<Corner> corners(text.size() * 64);
    const int quads = stb_easy_font_print(0, 0, text.data(), nullptr, corners.data(),
                                          static_cast<int>(corners.size() * sizeof(Corner)));
    for (int q = 0; q < quads; ++q) {
      const Corner &first = corners[static_cast<std::size_t>(4 * q)],
                   &last = corners[static_cast<std::size_t>(4 * q + 2)];
      const auto scaled = [](float place) { return kZoom * static_cast<int>(place); };
      fill(left + scaled(first.x), top + scaled(first.y), scaled(last.x - first.x), scaled(last.y - first.y), kInk);
    }
  }

  std::string png() const {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(width);
    image.height = static_cast<png_uint_32>(height);
    image.format = PNG_FORMAT_RGB_COLORMAP;
    // If no foreign code fails, the palette leaves out the colours of its failures.
    const bool fails = std::any_of(colours.begin(), colours.end(), [](std::uint8_t c) { return c > kPaper; });
    image.colormap_entries = fails ? std::size(kPalette) : kPaper + 1;
    png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
    std::string bytes(size, '\0');
    if (!png_image_write_to_memory(&image, bytes.data(), &size, 0, colours.data(), 0, kPalette))
      throw std::runtime_error(std::string("cannot make a PNG picture: ") + image.message);
    bytes.resize(size);
    return bytes;
  }
};

Image picture(const analysis::UlpPanel& panel) {
  Image image(analysis::kMapSize, analysis::kMapSize, kPaper);
  std::transform(panel.cells.begin(), panel.cells.end(), image.colours.begin(),
                 [](analysis::Cell cell) { return colour_of(static_cast<std::size_t>(cell)); });
  constexpr int kNear = 3, kLength = 8;
  for (const int at : {analysis::kMapCentre - kNear - kLength + 1, analysis::kMapCentre + kNear}) {
    image.fill(at, analysis::kMapCentre, kLength, 1, kInk);
    image.fill(analysis::kMapCentre, at, 1, kLength, kInk);
  }
  return image;
}

using CellCounts = std::array<int, analysis::kCellKinds>;

constexpr std::size_t kFirstOfLanes = 2;  // the text does not count a lane's correct verdicts

std::string words_of(const CellCounts& counts, std::size_t first) {
  std::string text;
  for (std::size_t kind = first; kind < analysis::kCellKinds; ++kind) {
    if (counts[kind] > 0)
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", grouped(static_cast<std::uint64_t>(counts[kind])),
                          kCellNames[kind]);
  }
  return text.empty() ? "right everywhere" : text;
}

std::string counts_of(const analysis::UlpPanel& panel) {
  return words_of(panel.counts(), panel.lane ? kFirstOfLanes : 0);
}

// Whether counts_of can write this text for a panel of the truth or of a lane.
bool are_counts(const std::string& text, bool of_truth) {
  CellCounts counts{};
  int all = 0;
  for (std::size_t begin = 0; begin < text.size() && text != words_of({}, 0);) {
    const std::size_t end = std::min(text.find(", ", begin), text.size()), space = std::min(text.find(' ', begin), end);
    std::string digits = text.substr(begin, space - begin);
    std::erase(digits, ',');
    const std::string name = text.substr(std::min(space + 1, end), end - std::min(space + 1, end));
    const auto kind = std::find(std::begin(kCellNames), std::end(kCellNames), name) - std::begin(kCellNames);
    const std::uint64_t count = parse_whole(digits).value_or(0);
    if (kind == analysis::kCellKinds || count > static_cast<std::uint64_t>(kMapCells - all)) return false;
    all += counts[static_cast<std::size_t>(kind)] = static_cast<int>(count);
    begin = end + 2;
  }
  return words_of(counts, of_truth ? 0 : kFirstOfLanes) == text && (!of_truth || all == kMapCells);
}

// For each kind of cell, whether some panel contains it.
std::array<bool, analysis::kCellKinds> kinds_in(const analysis::UlpMap& map) {
  std::array<bool, analysis::kCellKinds> found{};
  for (const analysis::UlpPanel& panel : map.panels) {
    for (const analysis::Cell cell : panel.cells) found[static_cast<std::size_t>(cell)] = true;
  }
  return found;
}

constexpr const char* kBase64 = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/=";

std::string base64(std::string bytes) {
  namespace iterators = boost::archive::iterators;
  using Letters = iterators::base64_from_binary<iterators::transform_width<std::string::const_iterator, 6, 8>>;
  const std::size_t missing = (3 - bytes.size() % 3) % 3;
  bytes.append(missing, '\0');
  std::string letters(Letters(bytes.cbegin()), Letters(bytes.cend()));
  letters.replace(letters.size() - missing, missing, missing, '=');
  return letters;
}

std::vector<std::string> hex(const AnyPair& pair) {
  std::vector<std::string> texts;
  visit(pair, [&](const auto& own) {
    for (int c = 0; c < kCoordinates; ++c) texts.push_back(fmt::format("{:a}", coordinates(own)[c]));
  });
  if (!pair.floats) texts.push_back("f64");
  return texts;
}

}  // namespace

std::string panel_png(const analysis::UlpPanel& panel) { return picture(panel).png(); }

std::string sheet_png(const analysis::UlpMap& map) {
  const int lanes = static_cast<int>(map.panels.size()) - 1;
  const int columns = 1 + std::min(lanes, kLanesARow), rows = std::max(1, (lanes + kLanesARow - 1) / kLanesARow);
  const int row_height = kSide + 2 * kLine + kMargin;
  Image sheet(kMargin + columns * (kSide + kMargin), kMargin + rows * row_height + 3 * kLine, kPaper);
  for (int p = 0; p <= lanes; ++p) {
    const analysis::UlpPanel& panel = map.panels[static_cast<std::size_t>(p)];
    const int column = p == 0 ? 0 : 1 + (p - 1) % kLanesARow, row = p == 0 ? 0 : (p - 1) / kLanesARow;
    const int left = kMargin + column * (kSide + kMargin), top = kMargin + row * row_height;
    sheet.write(left, top, panel.name());
    sheet.write(left, top + kLine, counts_of(panel));
    const Image small = picture(panel);
    for (int i = 0; i < analysis::kMapSize * analysis::kMapSize; ++i) {
      sheet.fill(left + i % analysis::kMapSize * kZoom, top + 2 * kLine + i / analysis::kMapSize * kZoom, kZoom, kZoom,
                 small.colours[static_cast<std::size_t>(i)]);
    }
  }
  int top = kMargin + rows * row_height;
  sheet.write(kMargin, top,
              fmt::format("{} to the right, {} upwards; a cell is one ulp; the cross is at the pair itself",
                          analysis::name_of_coordinate(map.moved.x), analysis::name_of_coordinate(map.moved.y)));
  top += kLine;
  int left = kMargin;
  const std::array<bool, analysis::kCellKinds> found = kinds_in(map);
  for (std::uint8_t kind = 0; kind < analysis::kCellKinds; ++kind) {
    if (!found[kind]) continue;
    std::string name = kCellNames[kind];
    sheet.fill(left, top, 16, 16, kInk);
    sheet.fill(left + 1, top + 1, 14, 14, colour_of(kind));
    sheet.write(left + kLine, top, name);
    left += 2 * kLine + kZoom * stb_easy_font_width(name.data());
  }
  return sheet.png();
}

namespace {

nlohmann::ordered_json legend_of(std::size_t kind) {
  const auto& [red, green, blue] = kPalette[colour_of(kind)];
  return {{"colour", fmt::format("#{:02x}{:02x}{:02x}", red, green, blue)}, {"means", kCellNames[kind]}};
}

// The fields of a map that describe its coordinates.
nlohmann::ordered_json frame_of(const std::string& x, const std::string& y) {
  return {{"title", fmt::format("{} and {} moved by up to {} ulps", x, y, analysis::kMapCentre)},
          {"x", x},
          {"y", y},
          {"size", analysis::kMapSize}};
}

}  // namespace

nlohmann::ordered_json to_json(const analysis::UlpMap& map) {
  nlohmann::ordered_json json =
      frame_of(analysis::name_of_coordinate(map.moved.x), analysis::name_of_coordinate(map.moved.y));
  json["legend"] = nlohmann::ordered_json::array();
  const std::array<bool, analysis::kCellKinds> found = kinds_in(map);
  for (std::size_t kind = 0; kind < analysis::kCellKinds; ++kind) {
    if (found[kind]) json["legend"].push_back(legend_of(kind));
  }
  json["pair"] = hex(map.pair);
  for (const analysis::UlpPanel& panel : map.panels)
    json["panels"].push_back({{"name", panel.name()}, {"shows", counts_of(panel)}, {"png", base64(panel_png(panel))}});
  return json;
}

bool is_map_of(const nlohmann::ordered_json& json, const AnyPair& pair, const std::vector<std::string>& lanes) try {
  const std::string x = json.at("x"), y = json.at("y");
  if (!analysis::coordinate_of_name(x) || !analysis::coordinate_of_name(y) || json.at("pair") != hex(pair))
    return false;
  const nlohmann::ordered_json frame = frame_of(x, y);
  for (const auto& [key, value] : frame.items()) {
    if (json.at(key) != value) return false;
  }
  for (const char* list : {"legend", "panels"}) {
    if (!json.at(list).is_array()) return false;
  }
  for (const nlohmann::ordered_json& row : json.at("legend")) {
    std::size_t kind = 0;
    while (kind < analysis::kCellKinds && row != legend_of(kind)) ++kind;
    if (kind == analysis::kCellKinds) return false;
  }
  std::vector<std::string> names;
  for (const nlohmann::ordered_json& panel : json.at("panels")) {
    const std::string name = panel.at("name");
    const bool of_truth = names.empty();
    if (of_truth ? name != "truth"
                 : std::find(lanes.begin(), lanes.end(), name) == lanes.end() ||
                       std::find(names.begin(), names.end(), name) != names.end())
      return false;
    if (panel.at("png").get<std::string>().find_first_not_of(kBase64) != std::string::npos ||
        !are_counts(panel.at("shows"), of_truth))
      return false;
    names.push_back(name);
  }
  return !names.empty();
} catch (const nlohmann::ordered_json::exception&) {
  return false;
}

}  // namespace graze::reports
