// SPDX-License-Identifier: Apache-2.0
#include "core/lanes/policies.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <optional>
#include <set>

#include "core/error.h"
#include "core/text.h"

namespace graze {
namespace {

[[noreturn]] void refuse(std::string_view text, const std::string& why = "") {
  std::string forms = "zero, abs:E, rel:K, SITE=abs:E,…";
  for (const std::string_view named : kNamedPolicies)
    forms += (named == *std::rbegin(kNamedPolicies) ? " or " : ", ") + std::string(named);
  throw UsageError("expected a policy (" + forms + "), found " + shown(text) + why);
}

// The epsilons in published code.
struct Shipped {
  std::string_view algorithm;
  Site site;
  double epsilon;
};
constexpr Shipped kShipped[] = {
    // T. Moller's published code (opttritri.txt and tritri_isectline.txt): #define EPSILON 0.000001, and
    // if(FABS(du0)<EPSILON) du0=0.0; for each plane distance, which is not normalised.
    {"moller_1997", Site::plane_distance, 1e-6},
};

std::optional<Site> site_of(std::string_view name) {
  for (int s = 0; s < kSiteCount; ++s) {
    if (graze::name(static_cast<Site>(s)) == name) return static_cast<Site>(s);
  }
  return std::nullopt;
}

std::string site_names() {
  std::string names;
  for (int s = 0; s < kSiteCount; ++s) names += (s ? ", " : "") + std::string(name(static_cast<Site>(s)));
  return names;
}

// Sets the site's tolerance from "abs:E" or "rel:K"; without a site, sets those of all sites.
void set(std::string_view whole, std::string_view text, std::optional<Site> site, Epsilons& epsilons) {
  const bool relative = text.starts_with("rel:");
  if (!relative && !text.starts_with("abs:")) refuse(whole);
  const std::string_view number = text.substr(4);
  double value = 0;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
  if (error != std::errc() || end != number.data() + number.size() || !std::isfinite(value) || std::signbit(value))
    refuse(whole, ": " + shown(number) + " is not a number of at least 0");
  double(&of_sites)[kSiteCount] = relative ? epsilons.relative : epsilons.absolute;
  for (int s = 0; s < kSiteCount; ++s) {
    if (!site || static_cast<int>(*site) == s) of_sites[s] = value;
  }
}

}  // namespace

Policy parse_policy(std::string_view text, const AlgorithmInfo& info) {
  Policy policy;
  if (text == "bound" || text == "filtered") {
    if (!info.right_without_rounding)
      refuse(text, ": " + std::string(info.id) + " is wrong on some pairs even without rounding, so no bound helps");
    policy.kind = text == "bound" ? Policy::Kind::bound : Policy::Kind::filtered;
    return policy;
  }
  if (text == "paper") {
    bool any = false;
    for (const Shipped& shipped : kShipped) {
      if (shipped.algorithm != info.id) continue;
      policy.epsilons.absolute[static_cast<int>(shipped.site)] = shipped.epsilon;
      any = true;
    }
    if (!any)
      refuse(text, ": the paper of " + std::string(info.id) + " compares with zero, like the lane without a policy");
    return policy;
  }
  if (text.find('=') == text.npos) {
    set(text, text, std::nullopt, policy.epsilons);
    return policy;
  }
  std::set<std::string_view> given;
  for (std::string_view rest = text; !rest.empty();) {
    const std::string_view part = rest.substr(0, rest.find(','));
    rest.remove_prefix(std::min(part.size() + 1, rest.size()));
    const std::size_t equals = part.find('=');
    if (equals == part.npos) refuse(text);
    const std::optional<Site> site = site_of(part.substr(0, equals));
    if (!site) refuse(text, ": the sites are " + site_names());
    if (const std::string_view form = part.substr(0, part.find(':')); !given.insert(form).second)
      refuse(text, ": it gives " + std::string(form) + " twice; leave one out");
    set(text, part.substr(equals + 1), site, policy.epsilons);
  }
  return policy;
}

}  // namespace graze
