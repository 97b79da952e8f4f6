// One line of a spectrum, at a frequency that no bin need have.
#pragma once

#include <complex>
#include <vector>

namespace host_sim {

/// a − ib of the part a cos 2πft + b sin 2πft of a signal, through a Hann window w:
///
///   (1)  a − ib = 2/Σw · Σ_k w_k x_k e^{−2πi f t_k},   t_k = first_time + k · period
///
/// A line further away than two bins, 2/(n · period), leaks less than 3 % of itself; white noise σ gives a and b a
/// standard deviation of σ √(3/n). 0 for an empty signal.
[[nodiscard]] std::complex<double> line_in(const std::vector<double>& signal, double frequency, double period,
                                           double first_time);

}  // namespace host_sim
