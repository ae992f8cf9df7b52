// Antialiasing to a stated error: samples go where they lower the estimated error most.
#pragma once
#include <core/trace/sampler.hpp>
#include <core/trace/tiles.hpp>

namespace rt::trace {

/// Samples the pixels of `region` until the estimated root mean square error of the region, over
/// pixels and channels, against the mean over each pixel's square, is at most `rmse`, or the time
/// budget is spent. Fills frame, counts, complete and estimatedError of `result`.
///
/// The passes form one fixed sequence for a scene; `rmse` and the time only decide after which of
/// them it ends. So the picture depends on nothing but the scene and the estimate that was reached.
void sampleAdaptively(const View& view, Sampler sampler, double rmse, const Region& region,
                      const Options& options, Result& result);

} // namespace rt::trace
