// SPDX-License-Identifier: Apache-2.0
// Decodes pictures with the PNG library, and tests that each pixel has its cell's colour.
#include "reports/ulp_map_picture.h"

#include <gtest/gtest.h>
#include <png.h>

#include <set>

namespace graze::reports {
namespace {

struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint32_t> pixels;  // 0xRRGGBB

  explicit Picture(const std::string& bytes) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    if (!png_image_begin_read_from_memory(&image, bytes.data(), bytes.size())) throw std::runtime_error(image.message);
    image.format = PNG_FORMAT_RGB;
    std::vector<std::uint8_t> rgb(PNG_IMAGE_SIZE(image));
    if (!png_image_finish_read(&image, nullptr, rgb.data(), 0, nullptr)) throw std::runtime_error(image.message);
    width = static_cast<int>(image.width);
    height = static_cast<int>(image.height);
    for (std::size_t i = 0; i < rgb.size(); i += 3)
      pixels.push_back(static_cast<std::uint32_t>(rgb[i] << 16 | rgb[i + 1] << 8 | rgb[i + 2]));
  }
};

const Pair kPair{{{0, 0, 0}, {1, 1, 0}, {1, 0, 0}}, {{0.75f, 0.75f, 0}, {0.75f, 0.75f, 1}, {0.5f, 0.75f, 1}}};

// A map whose rows each have one kind of cell, all kinds in turn.
analysis::UlpMap striped(int lanes) {
  analysis::UlpMap map{kPair, {9, 10}, {}};
  for (int p = 0; p <= lanes; ++p) {
    analysis::UlpPanel panel{p == 0 ? nullptr : &graze::lanes()[static_cast<std::size_t>(p - 1)], {}};
    for (int cell = 0; cell < analysis::kMapSize * analysis::kMapSize; ++cell)
      panel.cells.push_back(
          static_cast<analysis::Cell>(cell / analysis::kMapSize % (p == 0 ? 2 : analysis::kCellKinds)));
    map.panels.push_back(panel);
  }
  return map;
}

TEST(UlpMapPicture, HasAColourAKindAndACrossAroundThePair) {
  const analysis::UlpMap map = striped(1);
  const Picture picture(panel_png(map.panels[1]));
  ASSERT_EQ(picture.width, analysis::kMapSize);
  ASSERT_EQ(picture.height, analysis::kMapSize);
  const auto at = [&](int column, int row) {
    return picture.pixels[static_cast<std::size_t>(row * analysis::kMapSize + column)];
  };
  std::set<std::uint32_t> colours;
  for (int row = 0; row < analysis::kCellKinds; ++row) colours.insert(at(0, row));
  EXPECT_EQ(colours.size(), std::size_t{analysis::kCellKinds});
  int ink = 0;
  for (int row = 0; row < analysis::kMapSize; ++row) {
    for (int column = 0; column < analysis::kMapSize; ++column) {
      if (at(column, row) != at(0, row % analysis::kCellKinds)) {
        EXPECT_EQ(at(column, row), 0u);
        EXPECT_TRUE(column == analysis::kMapCentre || row == analysis::kMapCentre);
        ++ink;
      }
    }
  }
  EXPECT_EQ(ink, 32);
  EXPECT_EQ(at(analysis::kMapCentre, analysis::kMapCentre),
            at(0, analysis::kMapCentre % analysis::kCellKinds));  // the pair's own cell is visible
}

TEST(UlpMapPicture, SheetsHoldAllPanelsAtTwiceTheSize) {
  const analysis::UlpMap map = striped(8);
  const Picture one(sheet_png(striped(1))), nine(sheet_png(map));
  EXPECT_GT(one.width, 2 * 2 * analysis::kMapSize);
  EXPECT_GT(nine.width, 5 * 2 * analysis::kMapSize);
  EXPECT_GT(nine.height, one.height + 2 * analysis::kMapSize);
  const std::uint32_t declined = Picture(panel_png(map.panels[1])).pixels[4 * analysis::kMapSize];
  int found = 0;
  for (const std::uint32_t pixel : nine.pixels) found += pixel == declined;
  const int rows = analysis::kMapSize / analysis::kCellKinds;  // declined rows of each lane
  EXPECT_NEAR(found, 8 * 4 * rows * analysis::kMapSize, 8 * 4 * 32 + 14 * 14);
  EXPECT_EQ(sheet_png(map), sheet_png(striped(8)));
}

// The palette and the legend include failures of foreign code only if there are some.
TEST(UlpMapPicture, FailuresOfForeignCodeHaveColoursAndALegendOnlyWhereTheyAre) {
  analysis::UlpMap map = striped(1);
  for (analysis::Cell& cell : map.panels[1].cells) {
    if (cell > analysis::Cell::not_finite) cell = analysis::Cell::declined;
  }
  const auto palette_size = [](const std::string& png) {
    const std::size_t at = png.find("PLTE");
    return static_cast<unsigned char>(png.at(at - 1)) / 3;
  };
  EXPECT_EQ(palette_size(panel_png(map.panels[1])), 8);
  EXPECT_EQ(to_json(map)["legend"].size(), 6u);
  EXPECT_EQ(std::string(to_json(map)["panels"][1]["shows"]).find("crashed"), std::string::npos);
  const nlohmann::ordered_json json = to_json(striped(1));
  EXPECT_EQ(json["legend"].size(), 9u);
  EXPECT_EQ(json["legend"][6], (nlohmann::ordered_json{{"colour", "#009e73"}, {"means", "crashed"}}));
  EXPECT_NE(std::string(json["panels"][1]["shows"]).find(" timed out, "), std::string::npos);
}

TEST(UlpMapPicture, JsonIsThePairsOwn) {
  const nlohmann::ordered_json json = to_json(striped(2));
  EXPECT_EQ(json["x"], "b[0].x");
  EXPECT_EQ(json["size"], analysis::kMapSize);
  EXPECT_EQ(json["legend"][0], (nlohmann::ordered_json{{"colour", "#eeeeee"}, {"means", "disjoint"}}));
  ASSERT_EQ(json["panels"].size(), 3u);
  EXPECT_EQ(json["panels"][0]["name"], "truth");
  EXPECT_EQ(json["panels"][1]["name"], lanes()[0].id);
  EXPECT_EQ(json["panels"][0]["shows"], "32,768 disjoint, 32,768 intersects");
  const std::string png = json["panels"][0]["png"];
  EXPECT_EQ(png.substr(0, 11), "iVBORw0KGgo");  // "\x89PNG\r\n\x1a\n"
  EXPECT_EQ(png.size() % 4, 0u);
  EXPECT_EQ(png.size(), (panel_png(striped(2).panels[0]).size() + 2) / 3 * 4);
}

TEST(UlpMapPicture, OnlyAPossibleMapOfThePairIsTaken) {
  const std::vector<std::string> ids{lanes()[0].id, lanes()[1].id, lanes()[2].id};
  const nlohmann::ordered_json json = to_json(striped(2));
  EXPECT_TRUE(is_map_of(json, kPair, ids));
  EXPECT_FALSE(is_map_of(json, kPair, {ids[0]}));
  Pair other = kPair;
  other.b[2].z = -1;
  EXPECT_FALSE(is_map_of(json, other, ids));
  EXPECT_FALSE(is_map_of({}, kPair, ids));
  using Pointer = nlohmann::ordered_json::json_pointer;
  for (const auto& [at, value] : std::vector<std::pair<std::string, nlohmann::ordered_json>>{
           {"/x", "c[0].x"},
           {"/title", "mine"},
           {"/size", 255},
           {"/legend/0/colour", "#000000"},
           {"/legend", 1},
           {"/legend", nullptr},
           {"/panels", nullptr},
           {"/panels/1/png", "!!"},
           {"/panels/0/name", ids[2]},
           {"/panels/2/name", ids[0]},
           {"/panels/1/name", "truth"},
           {"/panels/1/png", 1},
           {"/panels/0/shows", "32,768 disjoint"},
           {"/panels/0/shows", "right everywhere"},
           {"/panels/1/shows", "65,537 declined"},
           {"/panels/1/shows", "1 mine"},
           {"/panels/1/shows", "0 declined"},
           {"/panels/1/shows", "1 declined, "},
           {"/panels/1/shows", "1 declined, 1 false negative"},
           {"/panels/1/shows", "40,000 false negative, 30,000 declined"},
           {"/panels/1/shows", "5 disjoint"},
           {"/panels/1/shows", ""},
           {"/panels/1", nullptr}}) {
    nlohmann::ordered_json changed = json;
    changed.at(Pointer(at)) = value;
    EXPECT_FALSE(is_map_of(changed, kPair, ids)) << at << ' ' << value;
  }
  for (const char* shows : {"right everywhere", "65,536 declined", "1 false positive, 12 not finite"}) {
    nlohmann::ordered_json changed = json;
    changed["panels"][1]["shows"] = shows;
    EXPECT_TRUE(is_map_of(changed, kPair, ids)) << shows;
  }
}

}  // namespace
}  // namespace graze::reports
