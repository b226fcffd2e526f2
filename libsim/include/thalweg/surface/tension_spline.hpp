// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace thalweg::surface {

/// A curve under tension over the edge from 0 to L: of all curves with given heights and slopes at both ends the one
/// with the least bending and stretching energy ∫₀ᴸ [F″² + α²(F′ − s)²] dt, s the slope of the chord (Nielson & Franke
/// 1984). Its tension σ = αL has no unit, so the curve does not depend on the unit of length. σ = 0 is the cubic
/// Hermite curve; with σ → ∞ the curve tends to its chord.
///
/// With b = t/L, a = F′(0) − s and c = F′(L) − s, Euler's equation F⁗ = α²F″ gives F = z₀ + s t + L [a φ(b) − c φ(1−b)]
/// and the energy (1/L) (d a² + 2e a c + d c²). The sum and the difference of φ(b) and φ(1−b) are the even and the odd
/// curve about the middle; with h = σ/2 and u = 2b − 1
///     φ(b) + φ(1−b) = [cosh h − cosh hu] / (2h sinh h)                  d − e = 2h coth h
///     φ(b) − φ(1−b) = [sinh hu − u sinh h] / [2 (h cosh h − sinh h)]    d + e = 2h² / (h coth h − 1)
/// which are power series in h² for σ < 1, and for larger σ functions of e^(−σb) and e^(−σ(1−b)) that cannot overflow.
/// Accuracy: φ and φ′ to 4e-15 absolute, d and e to 4e-15 relative, for σ from 0 to 1e15 (tests: against the
/// hyperbolic functions in more digits; energy by quadrature). Cost: tens of nanoseconds. The same bytes on every
/// machine, for the exponential is our own.

/// φ(b): the curve that leaves b = 0 with slope 1 and is 0 at both ends, with slope 0 at b = 1.
struct TensionShape {
    double value;
    double slope;  ///< φ′(b)
};

/// Tension ≥ 0 and finite, b in [0, 1].
TensionShape tension_shape(double tension, double b);

/// The energy of an edge of length L is (1/L) (own (a² + c²) + 2 cross a c); own is Nielson's d, cross his e.
struct EdgeEnergy {
    double own;
    double cross;  ///< always positive, at most own/2
};

/// Tension ≥ 0 and finite. Tension 0: 4 and 2; large tension: σ and 1.
EdgeEnergy tension_energy(double tension);

/// Heights and slopes of a curve under tension at its two ends.
struct TensionCurve {
    double length;                    ///< > 0, m
    double start_height, end_height;  ///< m
    double start_slope, end_slope;    ///< dF/dt, towards the end at both
    double tension;                   ///< ≥ 0, dimensionless
};

struct CurvePoint {
    double height;  ///< m
    double slope;
};

/// The curve `distance` metres from its start, 0 ≤ distance ≤ length.
CurvePoint point_on(const TensionCurve&, double distance);

/// ∫₀ᴸ [F″² + α²(F′ − s)²] dt, 1/m for heights in metres.
double energy(const TensionCurve&);

}  // namespace thalweg::surface
