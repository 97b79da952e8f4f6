#include "host_sim/fmu/slave.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <type_traits>
#include <utility>

#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "firmware/description/text/sha256.hpp"

namespace host_sim::fmu {
namespace {

constexpr std::string_view type_name(const Value& value) {
  constexpr std::array<std::string_view, 4> names{"Real (Float64)", "Integer (Int32)", "Boolean", "String"};
  return names[value.index()];
}

void demand_within(const std::string& name, double value, double lowest, double highest) {
  if (value >= lowest && value <= highest) return;
  throw CallError(name + " is " + firmware::shortest(value) + ", expected " + firmware::shortest(lowest) + " to " +
                  firmware::shortest(highest));
}

std::vector<Value> starts_of(const Variables& variables) {
  std::vector<Value> values;
  for (const Variable& variable : variables.list()) values.push_back(variable.start);
  return values;
}

}  // namespace

Slave::Slave(std::string text)
    : description_(firmware::parse_rig(text, description_resource)),
      guid_(firmware::sha256(text)),
      variables_(description_),
      values_(starts_of(variables_)) {}

void Slave::demand(bool allowed, const char* call) const {
  constexpr std::array<const char*, 4> phases{"before initialisation", "in initialisation mode", "in step mode",
                                              "after termination"};
  if (!allowed) throw CallError(std::string(call) + " is not allowed " + phases[static_cast<std::size_t>(phase_)]);
}

void Slave::set_up(double start, std::optional<double> stop) {
  demand(phase_ == Phase::instantiated, "to set up the experiment");
  if (!std::isfinite(start)) throw CallError("startTime is not finite, expected seconds");
  if (stop && !(*stop >= start)) throw CallError("stopTime is before startTime");
  start_ = start;
}

void Slave::enter_initialisation() {
  demand(phase_ == Phase::instantiated, "to enter initialisation mode");
  phase_ = Phase::initialising;
}

void Slave::exit_initialisation() {
  demand(phase_ == Phase::initialising, "to leave initialisation mode");
  ensure_run();
  phase_ = Phase::stepping;
}

void Slave::terminate() {
  demand(phase_ == Phase::stepping, "to terminate");
  phase_ = Phase::terminated;
}

void Slave::reset() {
  values_ = starts_of(variables_);
  phase_ = Phase::instantiated;
  start_ = beyond_ = 0.0;
  samples_ = 0;
  ended_ = false;
  given_.clear();
  point_ = {};
  run_.reset();
}

bool Slave::from_outside() const { return std::get<std::string>(values_[variables_.road]) == road_from_outside; }

firmware::Motion Slave::given() const {
  return {std::get<double>(values_[variables_.position]), std::get<double>(values_[variables_.velocity]),
          std::get<double>(values_[variables_.acceleration])};
}

bool Slave::at_start() const {
  return from_outside() && std::get<std::string>(values_[variables_.input_at]) == input_at_start;
}

/// The excitation so long [s] after the communication point.
firmware::Motion Slave::predicted(double ahead) const {
  firmware::Motion motion = given();
  if (motion.velocity != 0.0 || motion.acceleration != 0.0) {
    motion.position += ahead * motion.velocity + 0.5 * ahead * ahead * motion.acceleration;
    motion.velocity += ahead * motion.acceleration;
  } else if (point_.step > 0.0) {
    motion.position += (motion.position - point_.last) * (ahead / point_.step);
  }
  return motion;
}

/// To the next sample, so long [s] after the communication point. False: the firmware has ended the run.
bool Slave::advance(double ahead) {
  if (!from_outside()) return run_->advance({});
  if (!at_start()) {
    given_.push_back(given());
    return run_->advance(given_.back());
  }
  run_->save(before_);
  given_.push_back(predicted(ahead));
  if (run_->advance(given_.back())) return true;
  run_->restore(before_);
  given_.back() = given();
  return run_->advance(given_.back());
}

/// Carries out a predicted sample with the inputs that were set at its instant.
void Slave::settle() {
  point_.set = false;
  const firmware::Motion known = given();
  firmware::Motion& used = given_.back();
  if (known.position == used.position && known.velocity == used.velocity && known.acceleration == used.acceleration) {
    return;
  }
  run_->restore(before_);
  used = known;
  if (run_->advance(known)) return;
  ended_ = true;
  point_.predicted = false;
}

/// Goes to the first row with the parameters as they are.
void Slave::begin_run() {
  const auto real = [this](std::size_t index) { return std::get<double>(values_[index]); };
  firmware::RigDescription rig = description_;
  std::size_t at = variables_.first_number;
  for (const firmware::ParameterPath& path : firmware::parameter_paths()) {
    if (firmware::has_part(rig.rig, path.table)) path.value(rig.rig) = real(at++);
  }

  const auto seed = std::get<int>(values_[variables_.seed]);
  if (seed < 0) throw CallError("seed is " + std::to_string(seed) + ", expected 0 or above");
  SteppedRun::Options options;
  options.seed = static_cast<std::uint64_t>(seed);
  options.noise = std::get<bool>(values_[variables_.noise]) ? firmware::SimulatedRig::Noise::as_described
                                                            : firmware::SimulatedRig::Noise::none;
  if (!from_outside()) {
    constexpr std::string_view standard = "iso8608:";
    const std::string& name = std::get<std::string>(values_[variables_.road]);
    if (!name.starts_with(standard)) {
      throw CallError("road is " + firmware::in_quotes(name) + ", expected iso8608:A … iso8608:H or input");
    }
    demand_within("speed", real(variables_.speed), 0.1, 150.0);
    demand_within("bandwidth", real(variables_.bandwidth), 0.1, 0.2 * rig.sample_rate);
    demand_within("cut_off", real(variables_.cut_off), 0.001, 10.0);
    options.road = firmware::IsoRoad{firmware::class_roughness(name.substr(standard.size())), real(variables_.speed),
                                     real(variables_.cut_off), real(variables_.bandwidth), options.seed};
  }
  const std::string& point = std::get<std::string>(values_[variables_.input_at]);
  if (point != input_at_start && point != input_at_end) {
    throw CallError("input_at is " + firmware::in_quotes(point) + ", expected start or end");
  }
  auto run = std::make_shared<SteppedRun>(rig, options, given());
  if (!run->begun()) {
    throw CallError("the run was stopped before its first sample: " + std::string(firmware::name(run->trip().reason)));
  }
  run_ = std::move(run);
  given_.clear();
  if (from_outside()) given_.push_back(given());
}

void Slave::ensure_run() {
  if (!run_) begin_run();
}

bool Slave::step(double current, double size) {
  demand(phase_ == Phase::stepping, "a step");
  const double rate = description_.sample_rate;
  if (!std::isfinite(current) || !std::isfinite(size) || !(size > 0.0) || !(size * rate <= longest_step)) {
    throw CallError("a step of " + firmware::shortest(size) + " s from " + firmware::shortest(current) +
                    " s, expected a step above 0 and not beyond " + firmware::shortest(longest_step / rate) + " s");
  }
  if (!(std::fabs(current - time()) * rate <= point_tolerance)) {
    throw CallError("currentCommunicationPoint is " + firmware::shortest(current) + ", expected " +
                    firmware::shortest(time()) + ", where the last step ended");
  }
  if (point_.predicted) settle();
  point_.predicted = false;
  if (ended_) return false;
  const double periods = beyond_ + size * rate;
  const double nearest = std::round(periods);
  const bool whole = std::fabs(periods - nearest) <= period_rounding;
  const double due = whole ? nearest : std::floor(periods);
  for (double done = 1.0; done <= due; done += 1.0) {
    if (!advance((done - beyond_) / rate)) {
      beyond_ = 0.0;
      ended_ = true;
      return false;
    }
    ++samples_;
  }
  beyond_ = whole ? 0.0 : periods - due;
  point_ = {at_start() && whole && due > 0.0, false, std::get<double>(values_[variables_.position]), size};
  return true;
}

double Slave::time() const { return start_ + (static_cast<double>(samples_) + beyond_) / description_.sample_rate; }

std::string Slave::why_ended() const {
  if (!run_) return {};
  const firmware::Trip trip = run_->trip();
  return std::string(firmware::name(trip.reason)) +
         (trip.channel ? " of " + std::string(model::name(*trip.channel)) : std::string()) + ": " +
         firmware::shortest(trip.value) + ", limit " + firmware::shortest(trip.limit);
}

Value Slave::value_of(unsigned reference) {
  const Variable& variable = variables_.list()[reference];
  if (variable.causality != Causality::output) return values_[reference];
  demand(phase_ != Phase::instantiated, "to get an output");
  ensure_run();
  if (point_.predicted && point_.set) settle();
  if (reference == variables_.running) return !ended_;
  const firmware::Reason reason = ended_ ? run_->trip().reason : firmware::Reason::none;
  if (reference == variables_.reason) return static_cast<int>(reason);
  if (reference == variables_.reason_name) return std::string(firmware::name(reason));
  return firmware::RunColumns::value(variables_.columns()[reference - variables_.first_column], run_->row());
}

template <class T>
T Slave::get(unsigned reference) {
  if (reference >= values_.size()) throw CallError("no variable has the reference " + std::to_string(reference));
  Value value = value_of(reference);
  if (T* const wanted = std::get_if<T>(&value)) return std::move(*wanted);
  throw CallError(variables_.list()[reference].name + " is a " + std::string(type_name(value)));
}

template <class T>
void Slave::set(std::span<const unsigned> references, const std::vector<T>& values) {
  for (std::size_t i = 0; i < references.size(); ++i) {
    if (references[i] >= values_.size()) {
      throw CallError("no variable has the reference " + std::to_string(references[i]));
    }
    const Variable& variable = variables_.list()[references[i]];
    if (!std::holds_alternative<T>(values_[references[i]])) {
      throw CallError(variable.name + " is a " + std::string(type_name(values_[references[i]])));
    }
    if (variable.causality == Causality::output) throw CallError(variable.name + " is an output and cannot be set");
    if (variable.causality == Causality::parameter) {
      demand(phase_ == Phase::instantiated || phase_ == Phase::initialising, ("to set " + variable.name).c_str());
    } else {
      demand(phase_ != Phase::terminated, ("to set " + variable.name).c_str());
    }
    if constexpr (std::is_same_v<T, double>) {
      if (!std::isfinite(values[i])) {
        throw CallError(variable.name + " is " + firmware::shortest(values[i]) + ", expected a finite number");
      }
    }
  }
  for (std::size_t i = 0; i < references.size(); ++i) values_[references[i]] = T(values[i]);
  if (phase_ != Phase::stepping && !references.empty()) run_.reset();
  point_.set = true;
}

template double Slave::get(unsigned);
template int Slave::get(unsigned);
template bool Slave::get(unsigned);
template std::string Slave::get(unsigned);
template void Slave::set(std::span<const unsigned>, const std::vector<double>&);
template void Slave::set(std::span<const unsigned>, const std::vector<int>&);
template void Slave::set(std::span<const unsigned>, const std::vector<bool>&);
template void Slave::set(std::span<const unsigned>, const std::vector<std::string>&);

Slave::State Slave::state() const {
  State state{values_, phase_, start_, beyond_, samples_, ended_, given_, point_, run_, {}, {}};
  if (run_) state.saved = run_->save();
  if (point_.predicted) state.before = before_;
  return state;
}

void Slave::set_state(const State& state) {
  const auto same_run = state.run.lock();
  std::shared_ptr<SteppedRun> run = same_run && same_run == run_ ? run_ : nullptr;
  reset();
  values_ = state.values;
  start_ = state.start;
  if (run) {
    run_ = std::move(run);
    run_->restore(state.saved);
    before_ = state.before;
  } else if (state.phase == Phase::stepping || state.phase == Phase::terminated) {
    if (from_outside()) {  // it begins where it began
      values_[variables_.position] = state.given.front().position;
      values_[variables_.velocity] = state.given.front().velocity;
      values_[variables_.acceleration] = state.given.front().acceleration;
    }
    begin_run();
    for (std::uint64_t k = 0; k < state.samples + (state.ended ? 1U : 0U); ++k) {
      const std::size_t at = std::min(static_cast<std::size_t>(k) + 1, state.given.size() - 1);
      if (state.point.predicted && k + 1 == state.samples) run_->save(before_);
      if (!run_->advance(state.given.empty() ? firmware::Motion{} : state.given[at])) break;
    }
    values_ = state.values;
  }
  phase_ = state.phase;
  beyond_ = state.beyond;
  samples_ = state.samples;
  ended_ = state.ended;
  given_ = state.given;
  point_ = state.point;
}

namespace {

template <class T>
void put(std::string& bytes, const T& value) {
  const auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  bytes.append(raw.data(), raw.size());
}

/// Reads what put() wrote; CallError where the bytes end too soon.
struct Reader {
  std::string_view rest;

  template <class T>
  [[nodiscard]] T take() {
    std::array<char, sizeof(T)> raw{};
    const std::string_view bytes = take_bytes(sizeof(T));
    std::memcpy(raw.data(), bytes.data(), raw.size());
    return std::bit_cast<T>(raw);
  }
  [[nodiscard]] std::string_view take_bytes(std::size_t count) {
    if (count > rest.size()) throw CallError("a serialised state is cut off, expected all its bytes");
    const std::string_view bytes = rest.substr(0, count);
    rest.remove_prefix(count);
    return bytes;
  }
};

}  // namespace

std::string Slave::serialise(const State& state) const {
  std::string bytes = guid_;
  put(bytes, static_cast<std::uint64_t>(state.phase));
  put(bytes, state.start);
  put(bytes, state.beyond);
  put(bytes, state.samples);
  put(bytes, static_cast<std::uint64_t>(state.ended));
  for (const Value& value : state.values) {
    std::visit(
        [&bytes](const auto& v) {
          if constexpr (std::is_same_v<std::decay_t<decltype(v)>, std::string>) {
            put(bytes, static_cast<std::uint64_t>(v.size()));
            bytes += v;
          } else {
            put(bytes, static_cast<double>(v));
          }
        },
        value);
  }
  put(bytes, static_cast<std::uint64_t>(state.given.size()));
  for (const firmware::Motion& m : state.given) put(bytes, std::array{m.position, m.velocity, m.acceleration});
  put(bytes,
      std::array{state.point.predicted ? 1.0 : 0.0, state.point.set ? 1.0 : 0.0, state.point.last, state.point.step});
  return bytes + firmware::sha256(bytes);
}

Slave::State Slave::deserialise(std::string_view bytes) const {
  constexpr std::size_t digest = 64;
  if (bytes.size() < digest ||
      firmware::sha256(bytes.substr(0, bytes.size() - digest)) != bytes.substr(bytes.size() - digest)) {
    throw CallError("a serialised state is damaged, expected the bytes that this library gave");
  }
  Reader reader{bytes.substr(0, bytes.size() - digest)};
  if (reader.take_bytes(guid_.size()) != guid_) {
    throw CallError("a serialised state belongs to another rig description, expected one of " + guid_);
  }
  State state;
  state.phase = static_cast<Phase>(reader.take<std::uint64_t>());
  state.start = reader.take<double>();
  state.beyond = reader.take<double>();
  state.samples = reader.take<std::uint64_t>();
  state.ended = reader.take<std::uint64_t>() != 0;
  for (const Variable& variable : variables_.list()) {
    Value value = variable.start;
    if (auto* const text = std::get_if<std::string>(&value)) {
      *text = reader.take_bytes(static_cast<std::size_t>(reader.take<std::uint64_t>()));
    } else {
      const double number = reader.take<double>();
      if (auto* const real = std::get_if<double>(&value)) *real = number;
      if (auto* const integer = std::get_if<int>(&value)) *integer = static_cast<int>(number);
      if (auto* const boolean = std::get_if<bool>(&value)) *boolean = number != 0.0;
    }
    state.values.push_back(std::move(value));
  }
  const auto count = static_cast<std::size_t>(reader.take<std::uint64_t>());
  for (std::size_t i = 0; i < count; ++i) {
    const auto m = reader.take<std::array<double, 3>>();
    state.given.push_back({m[0], m[1], m[2]});
  }
  const auto point = reader.take<std::array<double, 4>>();
  state.point = {point[0] != 0.0, point[1] != 0.0, point[2], point[3]};
  return state;
}

}  // namespace host_sim::fmu
