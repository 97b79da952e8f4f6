// Every number that decides something in a transfer: value, unit, what it decides, where it comes from.
#pragma once

#include <cstddef>

namespace host_sim::transfer::thresholds {

// The sampler ---------------------------------------------------------------------------------------------------------

/// Chains that are stepped together: rigs that share the registers of one simulation, and the fewest with which R̂ sees
/// a chain that stays elsewhere. Half: R̂ scatters twice as much. Twice: half of the draws of each chain.
inline constexpr int chains = 8;
/// [1] Share of the draws that comes first, adapts the proposal and is thrown away. Half, twice: the same posterior in
/// sampler_test.
inline constexpr double burn_in = 0.2;
/// [1] Share of proposals from the Laplace approximation; the others walk. All from it: a chain stands still where its
/// tails are too light. None: 20 times fewer effective draws for 5 parameters.
inline constexpr double independent_share = 0.7;
/// [1] R̂ above which the draws are called not converged. Source: A. Vehtari et al., Bayesian Anal. 16, 2021 (1.01 for
/// four long chains; 1.05 leaves room for 1000 draws a chain). Half the excess: warns in one of ten good runs.
inline constexpr double largest_rhat = 1.05;
/// Effective draws below which bands are called uncertain: the 2.5 % quantile of 400 draws has a standard error of
/// 0.13 σ. Half: 0.19 σ. Twice: 0.09 σ.
inline constexpr double fewest_effective = 400.0;
/// [1] Ratio of standard deviations, sampled ÷ Laplace, beyond which (either way) the approximation is called wrong.
inline constexpr double laplace_ratio = 1.2;
/// [1] Ratio of a half width of estimate/uncertainty.hpp to that of the likelihood from which draws are stretched to
/// it. Twenty blocks know a width to 16 %, and Student's factor adds 7 %: below, a difference is their scatter. At 1:
/// ranks of a calibration bulge in the middle. Twice: bands that contradict each other by a factor of two pass.
inline constexpr double stretched_from = 1.3;
/// [1] Share of the draws within 2 % of a bound from which a posterior lies at its bounds. A uniform posterior, one the
/// data do not narrow, has 0.02 there. Half: uniform ones are said too. Twice: truths 1 σ beyond the bound pass.
inline constexpr double share_at_bound = 0.10, near_bound = 0.02;

// Models that the recordings leave open -------------------------------------------------------------------------------

/// [1] Odds against a rival from which it is left out of the average: 1/1000 of its band is below what 400 draws show.
inline constexpr double open_odds = 1000.0;
/// Rivals refitted at most.
inline constexpr std::size_t most_rivals = 6;
/// [1] Prior probability of one effect more that acts without having been named, of all candidates together, relative
/// to none. An effect that is named gained 40 of χ²; what gains less is likelier than not only if rigs have many small
/// effects. Half, twice: the mean of a model that wins moves by less than 1/20 of the probability.
inline constexpr double one_more_effect = 0.1;
/// [χ²] Gain from which one more effect is refitted for the average, and how many: below it, its odds are under 1/50.
inline constexpr double worth_refitting = 2.0;
inline constexpr std::size_t most_extensions = 4;
/// [ln] Widest prior of an effect's parameter: seven decades are any size.
inline constexpr double widest_prior = 16.0;

// Discrepancy ---------------------------------------------------------------------------------------------------------

/// [standard deviations] by which the power of a band exceeds the noise before it counts as a discrepancy. 13 bands: by
/// chance once in 60 transfers. Half: in most. Twice: a force error of 1.4 times the noise of a band is ignored.
inline constexpr double discrepancy_significance = 3.0;

// Prediction ----------------------------------------------------------------------------------------------------------

/// Predictive draws; the 2.5 % quantile of 400 has a standard error of 0.13 σ. For each single source fewer: a variance
/// from 96 draws is known to 14 %.
inline constexpr std::size_t predictive_draws = 400, source_draws = 96;
/// [Hz] Range of the responses: below, a road moves body and wheel alike; above, the tyre's contact patch averages.
inline constexpr double lowest_frequency = 0.5, highest_frequency = 25.0;
/// [s] Length of a block of the spectra: lines every 0.25 Hz, ten within the wheel's resonance.
inline constexpr double block = 4.0;
/// [1] Error of a simulation, relative to each line: that of identification/noise plus its own windows. Half, twice:
/// the same verdicts with the noise of the paper's sensors.
inline constexpr double simulation_error = 1e-3;

/// [1] Share of the predictive draws whose simulation stays finite, below which there is no prediction. What a
/// posterior allows and a rig cannot be is left out; half of it left out is another posterior.
inline constexpr double least_finite = 0.9;

// Validation ----------------------------------------------------------------------------------------------------------

/// [1] Family error: a prediction that holds is called wrong so often.
inline constexpr double family_error = 0.02;
/// [1] Relative deviation of a band's response that is worth a sentence. Less is not seen in a spectrum; a component's
/// model within 1 % is as good as its recordings. Half: 0.5 % beside a p of 1e-6 is called wrong. Twice: 2 % passes.
inline constexpr double worth_saying = 0.01;
/// [1] Power of the road in a line relative to the median over the range below which the line says nothing.
inline constexpr double least_power = 1e-4;
/// [standard deviations] by which the same effect on both rigs may differ: 0.3 % of equal ones are called different.
inline constexpr double equal_within = 3.0;
/// [1] Share of the second rig's motion inside what the first rig showed, below which a verdict is not given; and below
/// which the extrapolation is remarked on.
inline constexpr double least_overlap = 0.2, full_overlap = 0.9;

}  // namespace host_sim::transfer::thresholds
