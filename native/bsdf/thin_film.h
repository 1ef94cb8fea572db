// SPDX-License-Identifier: GPL-3.0-or-later
// Reflectance of an interface below a film so thin that what its two sides reflect interferes
// [Belcour17]. Each wavelength has an Airy series in the phase that light gains in the film; each
// channel sees a mean over wavelengths, so that a term of the series meets the Fourier transform of
// the channel's sensitivity at the film's optical path. As in Cycles there are three terms, and
// light is of equal energy.
//
// Directions and cosines as in fresnel.h. Where cos_o is beyond the film's critical angle all is
// reflected: what tunnels through is neglected.
#pragma once

#include "bsdf/closure.h"

namespace spc::facet {

// Over a dielectric of index `eta`, both over that of wo's side. The same from both sides.
Spectrum film_over_dielectric(const ThinFilm& film, float cos_o, float eta);
// Over a conductor of index eta + i k per channel, seen from vacuum.
Spectrum film_over_conductor(const ThinFilm& film, float cos_o, const Spectrum& eta,
                             const Spectrum& k);
// Over a metal that the F82 model describes: an index with this reflectance at normal incidence and
// of this one at 82 degrees [Gulbrandsen14] gives the phase, the model that the film's index makes
// of it the reflectance.
Spectrum film_over_f82(const ThinFilm& film, float cos_o, const Spectrum& f0, const Spectrum& at_82);

}  // namespace spc::facet
