#include "host_sim/frf/universal_file.hpp"

#include <cmath>
#include <vector>

#include "host_sim/recording_files/export/universal_records.hpp"
#include "host_sim/report/formatted.hpp"

namespace host_sim::frf {
namespace {

using universal::FunctionType;

universal::Axis axis_of(model::Channel channel) { return universal::axis_for(model::unit(channel)); }

void put_function(std::string& file, const Responses& r, const OutputResponse& o, FunctionType type, int number) {
  const bool response = type == FunctionType::frequency_response;
  universal::Function f;
  f.type = type;
  f.number = number;
  f.response = model::name(o.output);
  f.reference = model::name(r.request.input);
  f.response_node = universal::node_of(o.output);
  f.reference_node = universal::node_of(r.request.input);
  f.id[0] = (response ? std::string(name(r.request.estimator)) : "coherence") + " " + f.response + " / " + f.reference;
  f.id[1] = formatted("rigtwin frf, %zu averages worth %.1f, block %zu samples at %.9g Hz", r.averages,
                      r.effective_averages, r.blocks.scheme.length, r.sample_rate);
  if (r.request.instrument) f.id[3] = "instrument " + std::string(model::name(*r.request.instrument));
  f.complex = response;
  f.first = r.frequency.empty() ? 0.0 : r.frequency.front();
  f.increment = r.resolution();
  f.points = r.frequency.size();
  f.abscissa = universal::frequency_axis;
  f.ordinate = response ? axis_of(o.output) : universal::axis_for("", "Coherence");
  if (response) f.denominator = axis_of(r.request.input);
  std::vector<double> numbers;
  for (std::size_t k = 0; k < r.frequency.size(); ++k) {
    const bool known = std::isfinite(o.magnitude[k]);
    if (response) {
      numbers.push_back(known ? o.magnitude[k] * std::cos(o.phase[k]) : 0.0);
      numbers.push_back(known ? o.magnitude[k] * std::sin(o.phase[k]) : 0.0);
    } else {
      numbers.push_back(known ? o.coherence[k] : 0.0);
    }
  }
  file += universal::function_header(f) + universal::function_numbers(numbers) + universal::dataset_end();
}

}  // namespace

std::string to_universal_file(const Responses& responses) {
  std::string file = universal::units_dataset();
  int number = 0;
  for (const OutputResponse& output : responses.outputs) {
    ++number;
    put_function(file, responses, output, FunctionType::frequency_response, number);
    put_function(file, responses, output, FunctionType::coherence, number);
  }
  return file;
}

}  // namespace host_sim::frf
