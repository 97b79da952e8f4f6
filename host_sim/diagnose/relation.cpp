#include "host_sim/diagnose/relation.hpp"

#include <algorithm>

namespace host_sim::diagnose {

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
Origin sensor(Channel channel) { return {"sensor " + std::string(model::name(channel)), channel}; }

}  // namespace

Signal derived(Signal signal, int by) {
  for (Term& t : signal) t.order += by;
  return signal;
}

std::vector<Relation> relations_of(const model::RigParameters<double>& rig, const Recording& r) {
  const auto has = [&](Channel c) { return r.has(c); };
  const auto either = [&](Channel direct, const Signal& other) -> std::optional<Signal> {
    if (has(direct)) return Signal{{direct, 0, 1.0}};
    if (std::all_of(other.begin(), other.end(), [&](const Term& t) { return has(t.channel); })) return other;
    return std::nullopt;
  };
  std::vector<Relation> list;
  const auto dz_w = either(Channel::dz_w, {{Channel::z_r, 0, 1.0}, {Channel::z_w, 0, -1.0}});
  const auto add_tyre = [&](const std::vector<Origin>& origins) {
    if (!dz_w || !has(Channel::F_w)) return;
    const Signal spring = -rig.tyre.stiffness * *dz_w, damper = -rig.tyre.damping * derived(*dz_w, 1);
    list.push_back({"tyre: F_w = k_t dz_w + b_t ḋz_w",
                    origins,
                    Signal{{Channel::F_w, 0, 1.0}} + spring + damper,
                    {{"tyre.stiffness", spring}, {"tyre.damping", damper}},
                    {},
                    false,
                    *dz_w});
  };
  if (rig.kind != RigKind::quarter_car) {
    if (has(Channel::x_cmd) && has(Channel::x_act)) {
      list.push_back({"machine: x_act = M[x_cmd]",
                      {{"machine"}, sensor(Channel::x_act)},
                      {{Channel::x_act, 0, 1.0}},
                      {},
                      {},
                      true,
                      {{Channel::x_cmd, 0, 1.0}}});
    }
    if (has(Channel::x_act) && has(Channel::F)) {
      const Signal x{{Channel::x_act, 0, 1.0}};
      list.push_back({"component: F = F_s[x_act]",
                      {{"suspension"}, sensor(Channel::F), sensor(Channel::x_act)},
                      {{Channel::F, 0, 1.0}},
                      {},
                      x,
                      false,
                      x});
    }
    // The car of a hil rig is numbers of the program: no sensor is between.
    if (rig.kind == RigKind::hil) add_tyre({{"tyre"}});
    return list;
  }
  const auto body = either(Channel::zdd_b, {{Channel::z_b, 2, 1.0}});
  const auto wheel = either(Channel::zdd_w, {{Channel::z_w, 2, 1.0}});
  const auto dz_b = either(Channel::dz_b, {{Channel::z_w, 0, 1.0}, {Channel::z_b, 0, -1.0}});
  // Of a deflection that is made of two channels, either may be wrong.
  const auto with_sensors = [](std::vector<Origin> origins, const std::vector<Signal>& signals) {
    for (const Signal& signal : signals) {
      for (const Term& t : signal) origins.push_back(sensor(t.channel));
    }
    return origins;
  };
  if (body && dz_b) {
    Signal sum = rig.body.mass * *body;
    if (has(Channel::F_act)) sum = sum + Signal{{Channel::F_act, 0, -1.0}};
    list.push_back({"body: m_b z̈_b = F_s[dz_b]",
                    with_sensors({{"suspension"}, {"body guide"}}, {*body, *dz_b}),
                    sum,
                    {{"body.mass", rig.body.mass * *body}},
                    dz_b,
                    false,
                    *dz_b});
  }
  if (body && wheel && has(Channel::F_w)) {
    list.push_back({"balance: m_w z̈_w + m_b z̈_b = F_w",
                    with_sensors({{"wheel guide"}, {"body guide"}, sensor(Channel::F_w)}, {*body, *wheel}),
                    rig.wheel.mass * *wheel + rig.body.mass * *body + Signal{{Channel::F_w, 0, -1.0}},
                    {{"wheel.mass", rig.wheel.mass * *wheel}, {"body.mass", rig.body.mass * *body}},
                    {},
                    false,
                    dz_b.value_or(*wheel)});
  }
  if (dz_w) add_tyre(with_sensors({{"tyre"}, sensor(Channel::F_w)}, {*dz_w}));
  const auto kinematics = [&](const char* words, Channel a, std::optional<Channel> b, Channel d) {
    if (!has(a) || (b && !has(*b)) || !has(d)) return;
    Signal sum{{a, 0, 1.0}, {d, 2, -1.0}};
    Relation relation{words, {sensor(a), sensor(d)}, {}, {}, {}, false, {{d, 0, 1.0}}};
    if (b) {
      sum.push_back({*b, 0, -1.0});
      relation.origins.push_back(sensor(*b));
    }
    relation.sum = sum;
    list.push_back(relation);
  };
  kinematics("motion: z̈_w − z̈_b = d²dz_b/dt²", Channel::zdd_w, Channel::zdd_b, Channel::dz_b);
  kinematics("motion: z̈_r − z̈_w = d²dz_w/dt²", Channel::zdd_r, Channel::zdd_w, Channel::dz_w);
  kinematics("motion: z̈_r = d²z_r/dt²", Channel::zdd_r, std::nullopt, Channel::z_r);
  return list;
}

std::vector<double> samples_of(const Recording& recording, const Signal& signal, const SmoothWindow* window) {
  std::vector<double> sum(recording.size(), 0.0);
  for (const Term& t : signal) {
    const std::vector<double> part =
        window != nullptr ? (*window)(recording[t.channel], t.order) : recording[t.channel];
    for (std::size_t k = 0; k < sum.size(); ++k) sum[k] += t.factor * part[k];
  }
  return sum;
}

}  // namespace host_sim::diagnose
