#include "host_sim/live/live_watch.hpp"

#include <chrono>
#include <cmath>
#include <utility>

#include "firmware/description/model_watch.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/number_text.hpp"
#include "host_sim/live/live_report.hpp"
#include "host_sim/watch/controller_client.hpp"

namespace host_sim::live {

namespace {

/// Periods after which a period is late: the controller's own late_after.
constexpr double late = 0.25;
constexpr std::size_t most_waiting = 60'000;  // a minute at 1 kHz: more is a machine that cannot keep up
/// To be woken by each datagram would cost more than the diagnosis; a fifth of a block is soon enough.
constexpr std::chrono::milliseconds look_every{50};
constexpr double say_every = 0.5;  // [s] of the rig's clock: as often as a page without news hears something

std::string text_of(const nlohmann::json& setup, const char* key) {
  const auto found = setup.find(key);
  return found != setup.end() && found->is_string() ? found->get<std::string>() : std::string();
}

double number_of(const nlohmann::json& setup, const char* key) {
  const auto found = setup.find(key);
  return found != setup.end() && found->is_number() ? found->get<double>() : std::nan("");
}

}  // namespace

LiveSample sample_of(const watch::Datagram& datagram, double period) {
  LiveSample sample;
  sample.time = datagram.timestamp;
  if (datagram.value("late") > late * period) return sample;  // its samples are not those of that instant
  for (const auto& [name, value] : datagram.values) {
    if (const auto channel = model::find_channel(name)) {
      sample.values[index(*channel)] = value;
    } else if (name.starts_with("duct_") && name.size() == 6) {
      const auto duct = static_cast<std::size_t>(name[5] - '1');
      if (duct < sample.ducts.size()) sample.ducts[duct] = value;
    }
  }
  return sample;
}

std::optional<SetupObjection> setup_objection(const nlohmann::json& setup,
                                              const firmware::RigDescription& description) {
  if (!setup.is_object()) return std::nullopt;
  const std::string rig = firmware::in_quotes(text_of(setup, "rig")), kind = text_of(setup, "kind");
  const double rate = number_of(setup, "sample_rate"), every = number_of(setup, "every");
  const char* const the_right_one = "the description of the rig that runs";
  if (!kind.empty() && kind != model::name(description.rig.kind)) {
    return SetupObjection{"the controller runs " + rig + ", a " + kind + ", and " + description.source + " is a " +
                              std::string(model::name(description.rig.kind)),
                          the_right_one};
  }
  if (std::isfinite(rate) && std::abs(rate - description.sample_rate) > 1e-6 * rate) {
    return SetupObjection{"the controller of " + rig + " runs at " + firmware::shortest(rate) + " Hz, and " +
                              description.source + " says " + firmware::shortest(description.sample_rate) + " Hz",
                          the_right_one};
  }
  if (std::isfinite(every) && every > 1.0) {
    return SetupObjection{"the controller of " + rig + " publishes one period of " + firmware::shortest(every),
                          "every one (rig_controller --publish-every 1)"};
  }
  return std::nullopt;
}

LiveWatch::LiveWatch(const firmware::RigDescription& description, std::string socket, watch::Feed& feed,
                     std::function<void(const std::string&)> told)
    : description_(description),
      socket_(std::move(socket)),
      feed_(feed),
      told_(std::move(told)),
      diagnosis_(std::make_unique<LiveDiagnosis>(description)) {
  state_.progress = diagnosis_->progress();
  say();
  feed_.tap([this](const watch::Datagram& datagram) { receive(datagram); });
  thread_ = std::thread([this] { work(); });
}

LiveWatch::~LiveWatch() {
  feed_.tap({});
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    end_ = true;
  }
  news_.notify_all();
  thread_.join();
}

void LiveWatch::receive(const watch::Datagram& datagram) {
  Received received{sample_of(datagram, description_.period()), datagram.instance,
                    setup_objection(datagram.setup, description_),
                    !datagram.ended && (datagram.state == "running" || datagram.state == "holding")};
  if (!received.run && !received.objection) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  if (waiting_.size() >= most_waiting) waiting_.clear();  // a gap: the simulations begin anew
  waiting_.push_back(std::move(received));
}

void LiveWatch::work() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (true) {
    idle_.notify_all();
    news_.wait_for(lock, look_every, [this] { return end_; });
    if (end_) return;
    std::deque<Received> taken = std::exchange(waiting_, {});
    busy_ = true;
    lock.unlock();
    for (const Received& received : taken) diagnose(received);
    lock.lock();
    busy_ = false;
  }
}

void LiveWatch::finish() {
  std::unique_lock<std::mutex> lock(mutex_);
  idle_.wait(lock, [this] { return waiting_.empty() && !busy_; });
}

LiveWatch::State LiveWatch::state() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return state_;
}

void LiveWatch::diagnose(const Received& received) {
  if (!diagnosis_) return;
  std::vector<Finding> fresh;
  try {
    if (received.objection) {
      throw firmware::InputError("live", 0, received.objection->wrong, received.objection->expected);
    }
    if (received.instance != instance_) {
      if (!instance_.empty()) {
        earlier_.insert(earlier_.end(), diagnosis_->findings().begin(), diagnosis_->findings().end());
        diagnosis_ = std::make_unique<LiveDiagnosis>(description_);
      }
      instance_ = received.instance;
      begun_ = received.sample.time;
    }
    LiveSample sample = received.sample;
    sample.time -= begun_;
    fresh = diagnosis_->push(sample);
  } catch (const std::runtime_error& error) {
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      state_.error = error.what();
      state_.failure = std::current_exception();
    }
    diagnosis_.reset();
    say();
    return;
  }
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    state_.progress = diagnosis_->progress();
    state_.findings = earlier_;
    state_.findings.insert(state_.findings.end(), diagnosis_->findings().begin(), diagnosis_->findings().end());
  }
  for (const Finding& finding : fresh) {
    told_(sentence(finding));
    stop_rig(finding, received.instance);
  }
  const double since = received.sample.time - said_at_;
  if (fresh.empty() && since >= 0.0 && since < say_every) return;
  said_at_ = received.sample.time;
  say();
}

void LiveWatch::stop_rig(const Finding& finding, const std::string& instance) {
  using Kind = Finding::Kind;
  const bool wrong = finding.kind == Kind::named || finding.kind == Kind::stuck || finding.kind == Kind::lost;
  if (!wrong || !firmware::model_watch_stops(description_)) return;
  const watch::Answer answer = watch::ask_controller(socket_, (instance.empty() ? "" : "@" + instance + " ") + "stop");
  const auto reply = nlohmann::json::parse(answer.heard ? answer.text : "", nullptr, /*allow_exceptions=*/false);
  const bool done = reply.is_object() && reply.contains("ok") && reply["ok"] == true;
  const std::string said = done ? "the controller has taken the stop" : "no stop: " + answer.text;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    state_.stop = said;
    state_.stopped = state_.stopped || done;
  }
  told_(said);
}

void LiveWatch::say() {
  const State now = state();
  nlohmann::json model = to_json(now.progress, now.findings, now.stop);
  model["error"] = now.error;
  model["rig"] = description_.source;
  feed_.say_model(std::move(model));
}

}  // namespace host_sim::live
