// SPDX-License-Identifier: Apache-2.0
// Reads pairs in the case format and in every form that people paste. A pair that is read, written and read again must
// keep its bits.
#include <cstring>
#include <sstream>

#include "core/fuzz_target.h"
#include "corpus/pair_format.h"

namespace graze::corpus {
namespace {

void written_and_read_again(const Entry& entry) {
  std::ostringstream out;
  write_header(out);
  write_entry(out, entry);
  std::istringstream in(out.str());
  PairReader reader(in, "again", PairTypes::both);
  const std::optional<Entry> again = reader.next();
  must_hold(again.has_value(), "the written pair can be read");
  must_hold(again->doubles.has_value() == entry.doubles.has_value(), "the coordinate type is the same");
  visit(entry, [&](const auto& pair) {
    visit(*again, [&](const auto& other) {
      must_hold(!is_finite(pair) || (sizeof pair == sizeof other && std::memcmp(&pair, &other, sizeof pair) == 0),
                "the bits are the same");
    });
  });
  auto fields = entry.fields;
  if (entry.doubles && !field(entry, "coordinates")) fields.insert(fields.begin(), {"coordinates", "f64"});
  must_hold(again->fields == fields, "the fields are the same, except that the coordinate type may be added");
  must_hold(!reader.next(), "one entry reads back as one entry");
}

const RegisterFuzzTarget kPairs("pairs", [](std::string_view bytes) {
  for (const PairTypes taken : {PairTypes::f32, PairTypes::both}) {
    std::istringstream in{std::string(bytes)};
    PairReader reader(in, "pairs", taken);
    for (int entries = 0; entries < 100; ++entries) {
      try {
        const std::optional<Entry> entry = reader.next();
        if (!entry) break;
        must_hold(taken == PairTypes::both || !entry->doubles, "a reader of float32 returns no doubles");
        written_and_read_again(*entry);
      } catch (const FormatError& error) {
        must_be_one_line(error.what());
      }
    }
  }
});

}  // namespace
}  // namespace graze::corpus
