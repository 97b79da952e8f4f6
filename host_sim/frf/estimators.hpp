// Frequency response estimators and their 95 % bounds.
#pragma once

#include <complex>
#include <string_view>

namespace host_sim::frf {

using Complex = std::complex<double>;

/// Estimators of H in y = H x, and the noise that does not bias them:
///
///   (1)  H1 = S_xy/S_xx             noise in y
///   (2)  H2 = S_yy/S_yx             noise in x
///   (3)  Hv = √(S_yy/S_xx) S_xy/|S_xy|    noise in both, in equal parts of their powers
///   (4)  Hiv = S_zy/S_zx            noise in both, of any size and correlation, if the instrument z is free of it,
///                                   for example in a closed loop that is driven by z
///
/// (3) is total least squares with both signals scaled to equal power, √(H1 H2). (1) and (2) are (4) with z = x and
/// z = y. In a closed loop the noise of y reaches x, which biases (1)–(3) at any length of recording.
/// Sources: J. S. Bendat, A. G. Piersol, Random Data, 4th ed. 2010, ch. 6, 9; G. T. Rocklin, J. Crowley, H. Vold, Proc.
/// 3rd IMAC 1985, 272–278; L. Ljung, System Identification, 2nd ed. 1999, 13.5.
enum class Estimator : unsigned char { h1, h2, hv, instrument };

/// "H1", "H2", "Hv", "Hiv".
[[nodiscard]] std::string_view name(Estimator estimator);

/// Spectra at one frequency; S_ab = ⟨A* B⟩. Without an instrument z is x.
struct LineSpectra {
  double zz = 0.0, xx = 0.0, yy = 0.0;
  Complex zx, zy, xy;
};

/// |S_ab|²/(S_aa S_bb), in 0 … 1; 0 where a power is 0.
[[nodiscard]] double coherence(double aa, double bb, Complex ab);

/// (1)–(4); 0 or not finite where the dividing power is 0.
[[nodiscard]] Complex estimate(const LineSpectra& s, Estimator estimator);

/// The quantiles that bounds from K independent averages need, ν = 2(K − 1):
///
///   (5)  q₁ = t²/(ν + t²)            t: Student's 97.5 % quantile, ν degrees of freedom; for one real number,
///                                    two-sided
///   (6)  q₂ = 1 − 0.05^{1/(K − 1)}   for a complex number: the coherence that unrelated signals exceed with 5 %
///                                    probability
class Quantiles {
 public:
  explicit Quantiles(double averages);  ///< K > 1, need not be an integer; for K ≤ 1 all bounds are infinite

  [[nodiscard]] double one() const { return one_; }          ///< q₁
  [[nodiscard]] double complex() const { return complex_; }  ///< q₂

 private:
  double one_ = 1.0, complex_ = 1.0;
};

/// 97.5 % quantile of Student's distribution, ν ≥ 1 (need not be an integer), relative error 1e-8.
[[nodiscard]] double student_quantile(double degrees_of_freedom);

/// 95 % bounds of magnitude and phase, each holding with 95 % probability.
struct Bounds {
  double lowest_magnitude = 0.0;
  double highest_magnitude = 0.0;  ///< may be infinite
  double lowest_phase = 0.0;       ///< [rad], near the phase of the estimate; may exceed ±π
  double highest_phase = 0.0;
  bool determined = false;  ///< false: H is not distinguishable from 0; magnitude from 0, phase ± π about the estimate
};

/// Confidence region of H. For (1), (2), (4) the noise e = y − H x of the true H is independent of z, so the coherence
/// of z and e is as small as that of unrelated signals. All H with
///
///   (7)  |S_zy − H S_zx|² ≤ q S_zz (S_yy − 2 Re H* S_xy + |H|² S_xx),
///
/// form a disc with centre C and radius R. With q = q₂ the disc holds H with 95 % probability, exactly for Gaussian
/// noise and independent blocks, for any strength of the instrument. With q = q₁ the disc gives the bounds of single
/// numbers: |C| ± R for the magnitude, arg C ± asin(R/|C|) for the phase. For z = x this is Bendat and Piersol's R² = F
/// (1 − γ²) S_yy/S_xx · n/(2K − 2), with the quantile F of n = 1 number and n = 2. If the disc of q₂ contains 0 or is
/// the whole plane, H is not determined.
///
/// For (3), with γ² the coherence and the phase as of (1):
///
///   (8)  |H| = |Hv| exp(± asinh(t √((1 − γ²)/ν)))
///
/// Sources: T. W. Anderson, H. Rubin, Ann. Math. Stat. 20 (1949), 46–63, for (7); Bendat and Piersol, 9.2; E. J. G.
/// Pitman, Biometrika 31 (1939), 9–12, for (8), which is his interval for the ratio of two variances.
[[nodiscard]] Bounds bounds(const LineSpectra& s, Estimator estimator, const Quantiles& quantiles);

}  // namespace host_sim::frf
