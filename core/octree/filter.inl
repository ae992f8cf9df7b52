// What the f32 part of a leaf test may conclude.

/// The f32 edge functions of candidates() rule a triangle out only when two of them have opposite signs
/// for certain. Coordinates, brought to octree scale by a power of two, are rounded by u = 2^-24 each,
/// the two products and the difference once more: with m the largest coordinate an edge function is
/// off by at most 2m²·((1 + u)⁴ − 1) <= 8.1u·m². Scaled coordinates below 2^-126 and products below
/// 2^-126 lose at most 2^-149 and (3m + 1)·2^-148 more; overflow makes inf or NaN, which rule nothing
/// out.
constexpr float kFilterBound = static_cast<float>(10 * numeric::powerOfTwo(-24));
constexpr float kFilterUnderflow = static_cast<float>(numeric::powerOfTwo(-120));
