#include "host_sim/campaign/fleet.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace host_sim::campaign {
namespace {

/// |z| that the largest of n normal numbers exceeds once in twenty: n erfc(z/√2) = 0.05.
double largest_of(std::size_t n) {
  double low = 0.0, high = 10.0;
  for (int i = 0; i < 60; ++i) {
    const double z = 0.5 * (low + high);
    (static_cast<double>(n) * std::erfc(z / std::sqrt(2.0)) > 0.05 ? low : high) = z;
  }
  return high;
}

/// μ, 1/Σ v and τ² of some estimates: (2), (3).
struct Common {
  double mean = 0.0, variance = 0.0, between = 0.0;
};

double variance_of(const Estimate& e) {
  const double least = 1e-6 * std::max(std::abs(e.value), 1e-12);
  return std::pow(std::max(e.deviation(), least), 2);
}

/// Without the estimate `left_out` (its count: with all).
Common common_of(const std::vector<Estimate>& estimates, std::size_t left_out) {
  double w = 0.0, ww = 0.0, wx = 0.0;
  const auto each = [&](const auto& use) {
    for (std::size_t i = 0; i < estimates.size(); ++i) {
      if (i != left_out) use(estimates[i].value, variance_of(estimates[i]));
    }
  };
  each([&](double x, double variance) {
    w += 1.0 / variance;
    ww += 1.0 / (variance * variance);
    wx += x / variance;
  });
  const double middle = wx / w;
  double q = 0.0, count = 0.0;
  each([&](double x, double variance) {
    q += (x - middle) * (x - middle) / variance;
    count += 1.0;
  });
  Common common;
  const double room = w - ww / w;
  if (room > 0.0) common.between = std::max(0.0, (q - (count - 1.0)) / room);
  double v = 0.0, vx = 0.0;
  each([&](double x, double variance) {
    v += 1.0 / (variance + common.between);
    vx += x / (variance + common.between);
  });
  common.mean = vx / v;
  common.variance = 1.0 / v;
  return common;
}

void add_drift(const std::vector<Estimate>& members, double between, Quantity& q) {
  double v = 0.0, vt = 0.0, vtt = 0.0, vx = 0.0, vtx = 0.0;
  for (const Estimate& e : members) {
    const double weight = 1.0 / (variance_of(e) + between), t = static_cast<double>(e.record);
    v += weight;
    vt += weight * t;
    vtt += weight * t * t;
    vx += weight * e.value;
    vtx += weight * t * e.value;
  }
  const double determinant = v * vtt - vt * vt;
  if (!(determinant > 0.0)) return;
  q.slope = (v * vtx - vt * vx) / determinant;
  q.slope_deviation = std::sqrt(v / determinant);
}

}  // namespace

bool Quantity::drifts() const {
  return estimates.size() >= 5 && slope_deviation > 0.0 && std::abs(slope) > 3.0 * slope_deviation;
}

Quantity fleet_of(std::vector<Estimate> estimates) {
  Quantity q;
  q.estimates = std::move(estimates);
  const std::size_t count = q.estimates.size();
  if (count == 0) return q;
  for (std::size_t i = 0; i < count; ++i) {
    q.z.push_back(0.0);
    if (count < 4) continue;
    const Common others = common_of(q.estimates, i);
    const double variance = variance_of(q.estimates[i]) + others.between + others.variance;
    q.z.back() = (q.estimates[i].value - others.mean) / std::sqrt(variance);
  }
  const double limit = largest_of(count);
  std::vector<Estimate> members;
  for (std::size_t i = 0; i < count; ++i) {
    if (std::abs(q.z[i]) <= limit) members.push_back(q.estimates[i]);
  }
  const Common all = common_of(members, members.size());
  q.mean = all.mean;
  q.mean_deviation = std::sqrt(all.variance);
  q.spread = std::sqrt(all.between);
  for (std::size_t i = 0; i < count; ++i) {
    const bool member = std::abs(q.z[i]) <= limit;
    const double variance = variance_of(q.estimates[i]);
    const double share = member ? all.between / (all.between + variance) : 1.0;
    q.shrunk.push_back(all.mean + share * (q.estimates[i].value - all.mean));
    q.shrunk_deviation.push_back(std::sqrt(share * variance + (1.0 - share) * (1.0 - share) * all.variance));
  }
  add_drift(members, all.between, q);
  return q;
}

namespace {

struct Remarkable {
  double z = 0.0;
  std::string why;
};

/// The largest |z| of a row beyond `limit`, in words.
Remarkable by_value(const Campaign& campaign, std::size_t row, double limit) {
  Remarkable found;
  for (const auto& [name, q] : campaign.quantities) {
    for (std::size_t i = 0; i < q.estimates.size(); ++i) {
      if (q.estimates[i].record != row || std::abs(q.z[i]) <= std::max(limit, found.z)) continue;
      char text[160];
      std::snprintf(text, sizeof text, "%s is %.4g, the others %.4g ± %.2g", name.c_str(), q.estimates[i].value, q.mean,
                    std::hypot(q.spread, q.mean_deviation));
      found = {std::abs(q.z[i]), text};
    }
  }
  return found;
}

}  // namespace

Campaign campaign_of(std::vector<Row> rows) {
  Campaign campaign;
  campaign.rows = std::move(rows);
  std::map<std::string, std::vector<Estimate>> values;
  std::map<std::string, double> verdicts;
  for (const Row& row : campaign.rows) {
    verdicts[row.verdict] += 1.0;
    for (const auto& [name, value] : row.values) values[name].push_back(value);
  }
  std::size_t count = 0;
  for (auto& [name, estimates] : values) {
    if (estimates.size() < 2) continue;
    count += estimates.size();
    campaign.quantities[name] = fleet_of(std::move(estimates));
  }
  const double limit = largest_of(std::max<std::size_t>(count, 1)), total = static_cast<double>(campaign.rows.size());
  std::vector<std::pair<std::size_t, Remarkable>> found;
  for (std::size_t i = 0; i < campaign.rows.size(); ++i) {
    const Row& row = campaign.rows[i];
    Remarkable one = by_value(campaign, i, limit);
    if (!row.failure.empty()) one = {1e9, row.failure};
    if (one.why.empty() && verdicts[row.verdict] < 0.1 * total) one = {limit, "its verdict is " + row.verdict};
    if (!one.why.empty()) found.emplace_back(i, std::move(one));
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.second.z > b.second.z; });
  for (auto& [row, one] : found) {
    campaign.outliers.push_back(row);
    campaign.why.push_back(std::move(one.why));
  }
  return campaign;
}

}  // namespace host_sim::campaign
