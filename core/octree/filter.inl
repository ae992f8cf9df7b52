// What the f32 part of a leaf test may conclude.

/// The f32 edge functions of ruledIn() rule a triangle out only when two of them have opposite signs
/// for certain. Coordinates, brought to octree scale by a power of two, are rounded by u = 2^-24 each,
/// the two products and the difference once more: with m the largest coordinate an edge function is
/// off by at most 2m²·((1 + u)⁴ − 1) <= 8.1u·m². Scaled coordinates below 2^-126 and products below
/// 2^-126 lose at most 2^-149 and (3m + 1)·2^-148 more; overflow makes inf or NaN, which rule nothing
/// out.
constexpr float kFilterBound = static_cast<float>(10 * numeric::powerOfTwo(-24));
constexpr float kFilterUnderflow = static_cast<float>(numeric::powerOfTwo(-120));

/// The same for 16 rays and one triangle. Here corners c and origins o become f32 before they are
/// sheared, in octree space relative to one of the origins: with W >= |c| + |o| along every axis,
/// the differences c − o are off by 2uW each, of which the one along z enters with the shear, |shear| <= 1;
/// the shear adds uW, its product uW, the last difference 2uW. So sheared coordinates are off by
/// 8uW and, with the largest of them m <= 2W, edge functions by 2(2me + e²) + 4um² < 5e(m + e)
/// where e = 9uW. Moving far origins adds BoxRay's `extra` to two coordinates.
constexpr float kShearError = static_cast<float>(9 * numeric::powerOfTwo(-24));
constexpr float kEdgeError = 5.1f; // 5, and the roundings of the bound itself

/// At this scale f64 edge functions of world coordinates may underflow to 0, which counts as inside.
constexpr double kFilterLargestScale = 0x1p400;
