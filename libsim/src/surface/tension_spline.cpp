// SPDX-License-Identifier: GPL-3.0-or-later
#include "thalweg/surface/tension_spline.hpp"

#include "surface/shape.hpp"

namespace thalweg::surface {

TensionShape tension_shape(double tension, double b) {
    const Shape<double> shape = shape_of(tension, b);
    return {shape.value(1, 0), shape.slope(1, 0)};
}

EdgeEnergy tension_energy(double tension) {
    if (tension < series_below) {
        const double h2 = 0.25 * tension * tension;
        const double cosh_h = cosh_rest(h2);
        const double sinh_h = sinh_rest(h2);
        const double even = (1 + h2 * cosh_h) / (1 + h2 * sinh_h);
        const double odd = (1 + h2 * sinh_h) / (cosh_h - sinh_h);
        return {odd + even, odd - even};
    }
    const double whole = exp_minus(tension);
    const double rest = 1 - whole;
    const double scale = tension / (rest * (tension * (1 + whole) - 2 * rest));
    const double squares = 1 - whole * whole;
    return {scale * (tension * (1 + whole * whole) - squares), scale * (squares - 2 * tension * whole)};
}

CurvePoint point_on(const TensionCurve& curve, double distance) {
    const double chord = (curve.end_height - curve.start_height) / curve.length;
    const double a = curve.start_slope - chord;
    const double c = curve.end_slope - chord;
    const Shape<double> shape = shape_of(curve.tension, distance / curve.length);
    return {curve.start_height + chord * distance + curve.length * shape.value(a, -c), chord + shape.slope(a, -c)};
}

double energy(const TensionCurve& curve) {
    const double chord = (curve.end_height - curve.start_height) / curve.length;
    const double a = curve.start_slope - chord;
    const double c = curve.end_slope - chord;
    const EdgeEnergy of = tension_energy(curve.tension);
    return (of.own * (a * a + c * c) + 2 * of.cross * a * c) / curve.length;
}

}  // namespace thalweg::surface
