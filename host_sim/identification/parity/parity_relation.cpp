#include "host_sim/identification/parity/parity_relation.hpp"

#include <algorithm>

namespace host_sim::identification {

using model::Channel;
using model::RigKind;

namespace {

Signal operator*(double factor, Signal signal) {
  for (Term& t : signal) t.factor *= factor;
  return signal;
}
Signal operator+(Signal a, const Signal& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}
FaultOrigin sensor(Channel channel) { return {"sensor " + std::string(model::name(channel)), channel}; }

/// Makes the relations of one recording.
class RelationList {
 public:
  RelationList(const model::RigParameters<double>& rig, const firmware::Recording& recording)
      : rig_(rig),
        recording_(recording),
        dz_w_(either(Channel::dz_w, {{Channel::z_r, 0, 1.0}, {Channel::z_w, 0, -1.0}})) {}

  std::vector<ParityRelation> of_bench();
  std::vector<ParityRelation> of_driven_mass();
  std::vector<ParityRelation> of_car();

 private:
  [[nodiscard]] bool has(Channel channel) const { return recording_.has(channel); }

  /// A channel, or what it is made of where it is not recorded.
  [[nodiscard]] std::optional<Signal> either(Channel direct, const Signal& other) const {
    if (has(direct)) return Signal{{direct, 0, 1.0}};
    if (std::all_of(other.begin(), other.end(), [&](const Term& t) { return has(t.channel); })) return other;
    return std::nullopt;
  }

  /// Of a deflection that is made of two channels, either may be wrong.
  static std::vector<FaultOrigin> with_sensors(std::vector<FaultOrigin> origins, const std::vector<Signal>& signals) {
    for (const Signal& signal : signals) {
      for (const Term& t : signal) origins.push_back(sensor(t.channel));
    }
    return origins;
  }

  /// (3)
  void add_tyre(const std::vector<FaultOrigin>& origins) {
    if (!dz_w_ || !has(Channel::F_w)) return;
    const Signal spring = -rig_.tyre.stiffness * *dz_w_, damper = -rig_.tyre.damping * derived(*dz_w_, 1);
    list_.push_back({.words = "tyre: F_w = k_t dz_w + b_t ḋz_w",
                     .origins = origins,
                     .sum = Signal{{Channel::F_w, 0, 1.0}} + spring + damper,
                     .tolerated = {{"tyre.stiffness", spring}, {"tyre.damping", damper}},
                     .deflection = {},
                     .motion = *dz_w_});
  }

  /// (4)–(6): a − b = d²deflection/dt²
  void add_kinematics(const char* words, Channel a, std::optional<Channel> b, Channel deflection) {
    if (!has(a) || (b && !has(*b)) || !has(deflection)) return;
    ParityRelation relation{.words = words,
                            .origins = {sensor(a), sensor(deflection)},
                            .sum = {{a, 0, 1.0}, {deflection, 2, -1.0}},
                            .tolerated = {},
                            .deflection = {},
                            .motion = {{deflection, 0, 1.0}}};
    if (b) {
      relation.sum.push_back({*b, 0, -1.0});
      relation.origins.push_back(sensor(*b));
    }
    list_.push_back(relation);
  }

  const model::RigParameters<double>& rig_;
  const firmware::Recording& recording_;
  std::optional<Signal> dz_w_;
  std::vector<ParityRelation> list_;
};

/// (7), (8) and, in hil, (3)
std::vector<ParityRelation> RelationList::of_bench() {
  const Signal commanded{{Channel::x_cmd, 0, 1.0}}, reached{{Channel::x_act, 0, 1.0}};
  if (has(Channel::x_cmd) && has(Channel::x_act)) {
    list_.push_back({.words = "machine: x_act = M[x_cmd]",
                     .origins = {{"machine"}, sensor(Channel::x_act)},
                     .sum = reached,
                     .tolerated = {},
                     .deflection = {},
                     .machine = true,
                     .motion = commanded});
  }
  if (has(Channel::x_act) && has(Channel::F)) {
    list_.push_back({.words = "component: F = F_s[x_act]",
                     .origins = {{"suspension"}, sensor(Channel::F), sensor(Channel::x_act)},
                     .sum = {{Channel::F, 0, 1.0}},
                     .tolerated = {},
                     .deflection = reached,
                     .motion = reached});
  }
  // The car of a hil rig is computed by the program: no sensor is between.
  if (rig_.kind == RigKind::hil) add_tyre({{"tyre"}});
  return list_;
}

/// (9), (4)
std::vector<ParityRelation> RelationList::of_driven_mass() {
  const auto acceleration = either(Channel::zdd_b, {{Channel::x_act, 2, 1.0}});
  if (acceleration && has(Channel::F) && has(Channel::x_act)) {
    const Signal reached{{Channel::x_act, 0, 1.0}}, inertia = -rig_.body.mass * *acceleration;
    list_.push_back({.words = "mass: F − m ẍ = F_s[x_act]",
                     .origins = with_sensors({{"suspension"}, sensor(Channel::F)}, {*acceleration, reached}),
                     .sum = inertia + Signal{{Channel::F, 0, 1.0}},
                     .tolerated = {{"body.mass", inertia}},
                     .deflection = reached,
                     .motion = reached});
  }
  add_kinematics("motion: z̈_b = d²x_act/dt²", Channel::zdd_b, std::nullopt, Channel::x_act);
  return list_;
}

/// (1)–(6)
std::vector<ParityRelation> RelationList::of_car() {
  const auto body = either(Channel::zdd_b, {{Channel::z_b, 2, 1.0}});
  const auto wheel = either(Channel::zdd_w, {{Channel::z_w, 2, 1.0}});
  const auto dz_b = either(Channel::dz_b, {{Channel::z_w, 0, 1.0}, {Channel::z_b, 0, -1.0}});
  const double m_b = rig_.body.mass, m_w = rig_.wheel.mass;
  if (body && dz_b) {
    Signal sum = m_b * *body;
    if (has(Channel::F_act)) sum = sum + Signal{{Channel::F_act, 0, -1.0}};
    list_.push_back({.words = "body: m_b z̈_b = F_s[dz_b]",
                     .origins = with_sensors({{"suspension"}, {"body guide"}}, {*body, *dz_b}),
                     .sum = sum,
                     .tolerated = {{"body.mass", m_b * *body}},
                     .deflection = dz_b,
                     .motion = *dz_b});
  }
  if (body && wheel && has(Channel::F_w)) {
    list_.push_back({.words = "balance: m_w z̈_w + m_b z̈_b = F_w",
                     .origins = with_sensors({{"wheel guide"}, {"body guide"}, sensor(Channel::F_w)}, {*body, *wheel}),
                     .sum = m_w * *wheel + m_b * *body + Signal{{Channel::F_w, 0, -1.0}},
                     .tolerated = {{"wheel.mass", m_w * *wheel}, {"body.mass", m_b * *body}},
                     .deflection = {},
                     .motion = dz_b.value_or(*wheel)});
  }
  if (dz_w_) add_tyre(with_sensors({{"tyre"}, sensor(Channel::F_w)}, {*dz_w_}));
  add_kinematics("motion: z̈_w − z̈_b = d²dz_b/dt²", Channel::zdd_w, Channel::zdd_b, Channel::dz_b);
  add_kinematics("motion: z̈_r − z̈_w = d²dz_w/dt²", Channel::zdd_r, Channel::zdd_w, Channel::dz_w);
  add_kinematics("motion: z̈_r = d²z_r/dt²", Channel::zdd_r, std::nullopt, Channel::z_r);
  return list_;
}

}  // namespace

Signal derived(Signal signal, int by) {
  for (Term& t : signal) t.order += by;
  return signal;
}

std::vector<ParityRelation> parity_relations(const model::RigParameters<double>& rig,
                                             const firmware::Recording& recording) {
  RelationList list(rig, recording);
  if (rig.kind == RigKind::driven_mass) return list.of_driven_mass();
  return rig.kind == RigKind::quarter_car ? list.of_car() : list.of_bench();
}

std::vector<double> samples_of(const firmware::Recording& recording, const Signal& signal, const SmoothWindow* window) {
  std::vector<double> sum(recording.size(), 0.0);
  for (const Term& t : signal) {
    const std::vector<double> part =
        window != nullptr ? (*window)(recording[t.channel], t.order) : recording[t.channel];
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += t.factor * part[k];
  }
  return sum;
}

}  // namespace host_sim::identification
