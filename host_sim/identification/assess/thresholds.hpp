// Every number that decides something while a model is assessed.
#pragma once

#include <array>
#include <cstddef>

namespace host_sim::identification::thresholds {

/// Odds below which two models count as not told apart: verdict `ambiguous`. A simpler effect that is a limit of its
/// rival wins by the penalty of one parameter, odds of e⁵ = 148. Half: 5 % of a wrong name becomes 9 %. Twice: 2.4 %,
/// and more verdicts are ambiguous. Derived.
inline constexpr double close_odds = 20.0;
/// Alternatives of an effect that are listed at most.
inline constexpr std::size_t most_alternatives = 5;
/// [1] The confidence that is never exceeded: nobody has counted wrong names among more than a thousand. 54 of 57 names
/// with 0.9 … 1 were right where effects are weak (rigtwin_confusion --weak, 200 recordings).
inline constexpr double highest_confidence = 0.999;
/// [ln] Odds are capped at e³⁰⁰, so that they stay finite numbers.
inline constexpr double most_logarithmic_odds = 300.0;
/// [1] Of rigs that have something to find, so many have something that is not in the catalogue. Derivation: six of the
/// catalogue's 36 effects (asymmetric_damper, bouc_wen, hardening_hysteresis, moving_mass, position_ripple,
/// stribeck_friction) were added since rigs had shown them; that the next one must be, too, has the probability
/// (6 + 1)/(36 + 2) = 0.18 (Laplace's rule of succession), rounded up. And the share q of its power by which a law
/// outside the catalogue differs from the nearest effect is at least this: a law within 3 % of an effect's force, the
/// tolerance of a spring, is that effect; 0.03² = 1e-3. On 13 recordings, seed 11, no verdict and no name changes at
/// half or twice of either; of names that are in doubt, half of `outside_share` moves the confidence from 0.90 to 0.95
/// and twice to 0.80, `closest_outside` by 0.01 either way.
inline constexpr double outside_share = 0.2, closest_outside = 1e-3;
/// [1] Factor on the confidence of an effect whose law is in doubt (select/law_constancy), or that could imitate others
/// (EffectCard::imitates) and leaves a rest, or that gains less than twice the step changes: its law is another one, or
/// something else hides at its place. Below a half, so that no such name is believed; not 0, since the effect still is
/// what comes nearest. Half and twice: other numbers below a half.
inline constexpr double inconstant_worth = 0.3;
/// [1] Least confidence of a name beside an unexplained residual: this times the share of the pooled error that goes
/// away.
inline constexpr double worth_of_shrinking = 0.5;
/// [1] Where a model leaves more than noise: by how much a cause may raise the error of what is held out and is still a
/// cause. Derivation: errors of a quarter of a minute scatter by some per cent of what noise leaves of them, which is
/// less than this share of an error above the noise. Half and twice: the same names on the recordings of
/// ../shared/real.
inline constexpr double raises_error = 0.02;
/// [1] A channel with less of the excess is no place of the disagreement.
inline constexpr double least_located_share = 0.005;

/// [s] Either way, half width of the instants at which an event begins and ends: two blocks of parity's span_block and
/// the reach of its smooth window. Derived.
inline constexpr double event_edge = 0.035;

/// [1] By how much the found model's answer to a line on its input may be wrong, relative to it: parameters are known
/// to some 0.1 %, a law with a corner answers to a small line as its motion has it. [noise of the sensor] Size of the
/// line that is tried.
inline constexpr double hum_model_error = 0.003, hum_trial = 3.0;

// Experiments ---------------------------------------------------------------------------------------------------------

/// [1] Noise of a sensor that the rig does not have yet, relative to the rms of its channel.
inline constexpr double new_sensor_noise = 0.01;
/// [times the displacement that was recorded] that an experiment may ask for; [times] how much better than the
/// recordings it must separate to be named. Half of the latter: an equal experiment is recommended.
inline constexpr double most_travel = 3.0, separates_better = 2.0;
/// [Hz], [m] Sines that a law is tested by: numbers that an operator types in, a factor of 2 or so apart. Half as many:
/// a weaker sine is named. Twice: the same one, at twice the time.
inline constexpr std::array sine_frequencies{0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0};
inline constexpr std::array sine_amplitudes{0.2e-3, 0.5e-3, 1e-3, 2e-3, 5e-3, 10e-3, 20e-3, 50e-3, 100e-3};
/// [s] Length that is simulated of each, two periods at least; [1/samples] the highest frequency, ten samples a period.
/// Half and twice: no difference.
inline constexpr double sine_seconds = 4.0, sine_highest = 0.1;

}  // namespace host_sim::identification::thresholds
