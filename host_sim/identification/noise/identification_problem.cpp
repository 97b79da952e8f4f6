#include "host_sim/identification/noise/identification_problem.hpp"

#include <algorithm>
#include <utility>

#include "host_sim/identification/common/parallel.hpp"

namespace host_sim::identification {
namespace {

/// [s] A truncated window is no shorter: two periods of 1 Hz.
constexpr double shortest_truncated = 2.0;

}  // namespace

IdentificationProblem::IdentificationProblem(std::vector<PreparedRecording> recordings)
    : samples_(std::make_shared<const std::vector<PreparedRecording>>(std::move(recordings))) {
  for (const PreparedRecording& r : *samples_) {
    recordings_.push_back({&r, r.fitted, r.held_out, r.substeps, {}, std::nullopt, std::nullopt});
  }
  whiten();
}

IdentificationProblem::IdentificationProblem(std::vector<PreparedRecording> recordings, const Hypothesis& hypothesis)
    : IdentificationProblem(std::move(recordings)) {
  update_input_noise(hypothesis);
}

std::size_t IdentificationProblem::residual_count() const {
  std::size_t count = 0;
  for (const ProblemRecording& r : recordings_) count += r.is_fitted() ? r.fit_whitening->count() : 0;
  return count;
}

std::size_t IdentificationProblem::fitted_count() const {
  return static_cast<std::size_t>(
      std::count_if(recordings_.begin(), recordings_.end(), [](const ProblemRecording& r) { return r.is_fitted(); }));
}

bool IdentificationProblem::has_held_out() const {
  return std::any_of(recordings_.begin(), recordings_.end(), [](const ProblemRecording& r) { return r.is_held_out(); });
}

bool IdentificationProblem::update_input_noise(const Hypothesis& hypothesis) {
  if (!samples_->front().input_noise.any()) return false;
  for_all(recordings_.size(), [&](std::size_t i) {
    // Over the whole window, not a truncated one: the covariance is the same, and better known.
    const PreparedRecording& r = *recordings_[i].samples;
    recordings_[i].input_noise =
        input_noise_covariance(r, hypothesis, hypothesis.starts[i], r.fitted.size() > 0 ? r.fitted : r.held_out);
  });
  whiten();
  return true;
}

void IdentificationProblem::take_input_noise(const IdentificationProblem& other) {
  for (std::size_t i = 0; i < recordings_.size(); ++i) recordings_[i].input_noise = other.recordings_[i].input_noise;
  whiten();
}

void IdentificationProblem::allow_model_error(double relative) {
  model_error_ = relative;
  whiten();
}

IdentificationProblem IdentificationProblem::truncated(double share) const {
  IdentificationProblem part;
  part.samples_ = samples_;
  part.model_error_ = model_error_;
  for (const ProblemRecording& r : recordings_) {
    const auto least = static_cast<std::size_t>(shortest_truncated / r.samples->input.period);
    const auto wanted = static_cast<std::size_t>(share * static_cast<double>(r.fitted.size()));
    const Window begin{r.fitted.from, r.fitted.from + std::min(r.fitted.size(), std::max(wanted, least))};
    part.recordings_.push_back({r.samples, begin, {}, r.substeps, r.input_noise, std::nullopt, std::nullopt});
  }
  part.whiten();
  return part;
}

IdentificationProblem IdentificationProblem::truncated_and_coarse(double share) const {
  IdentificationProblem part = truncated(share);
  for (ProblemRecording& r : part.recordings_) r.substeps = (r.substeps + 1) / 2;
  return part;
}

Whitening IdentificationProblem::whitening(std::size_t recording, Window window) const {
  const ProblemRecording& r = recordings_[recording];
  return {*r.samples, window, r.input_noise.spectrum, model_error_};
}

void IdentificationProblem::whiten() {
  for_all(recordings_.size(), [&](std::size_t i) {
    ProblemRecording& r = recordings_[i];
    r.fit_whitening.reset();
    r.held_out_whitening.reset();
    if (r.fitted.size() > 0) r.fit_whitening.emplace(whitening(i, r.fitted));
    if (r.held_out.size() > 0) r.held_out_whitening.emplace(whitening(i, r.held_out));
  });
}

}  // namespace host_sim::identification
