//! Complex indices of the common metals.

use super::conductor::Metal;
use crate::math::Rgb;

/// Name, η and k, each by channel.
type Entry = (&'static str, [f32; 3], [f32; 3]);

/// η and k as linear sRGB.
///
/// # Source
/// The values that `scalar_rgb` of Mitsuba 3.9.1 reports for its plugin `conductor` with these names, which it
/// computes from measured spectra.
const METALS: [Entry; 15] = [
    ("Ag", [0.155276194, 0.116727956, 0.138387635], [4.82835436, 3.12222242, 2.14690113]),
    ("Al", [1.65750086, 0.880404711, 0.521244466], [9.22381115, 6.26950216, 4.83700418]),
    ("Au", [0.143035978, 0.375307083, 1.44204533], [3.98299694, 2.38555646, 1.60335922]),
    ("Be", [4.18501234, 3.18502927, 2.78406119], [3.83546591, 3.0101223, 2.868994]),
    ("Cr", [4.36966753, 2.91650534, 1.6549046], [5.20654678, 4.23130608, 3.75469875]),
    ("Cu", [0.201005474, 0.923749506, 1.10221541], [3.91326213, 2.45304513, 2.14208984]),
    ("Hg", [2.39893866, 1.44002795, 0.909570396], [6.32758713, 4.37192488, 3.42176366]),
    ("Ir", [3.0862999, 2.08219051, 1.61791456], [5.59215307, 4.06708813, 3.26731205]),
    ("K", [0.0640431866, 0.0464097671, 0.0381849147], [2.10419965, 1.34894001, 0.913125873]),
    ("Li", [0.265790939, 0.195618317, 0.220948622], [3.54015493, 2.31112337, 1.66860723]),
    ("Mo", [4.48397398, 3.52513075, 2.77631044], [4.11143732, 3.42082691, 3.15060735]),
    ("Na_palik", [0.0602693558, 0.0561409481, 0.061988432], [3.17927337, 2.11249042, 1.57904112]),
    ("Nb", [3.42007399, 2.79009318, 2.39562941], [3.44139457, 2.73766613, 2.57974577]),
    ("Rh", [2.5857935, 1.86021638, 1.55426335], [6.78226042, 4.70298719, 3.97607303]),
    ("W", [4.37081671, 3.30024648, 2.99840736], [3.50064063, 2.6048739, 2.27323318]),
];

impl Metal {
    /// The metal called `name`, spelt as the scene format spells it; `None` for an unknown name.
    pub fn by_name(name: &str) -> Option<Self> {
        let (_, eta, k) = METALS.iter().find(|(known, ..)| *known == name)?;
        Self::new(Rgb::from(*eta), Rgb::from(*k)).ok()
    }

    /// The names that [`Self::by_name`] knows.
    pub fn names() -> impl Iterator<Item = &'static str> {
        METALS.iter().map(|(name, ..)| *name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_has_a_metal_that_reflects_some_light_and_not_all() {
        for name in Metal::names() {
            let r = Metal::by_name(name).unwrap().reflectance(1.0);
            assert!(r.to_array().into_iter().all(|c| c > 0.1 && c < 1.0), "{name}: {r:?}");
        }
        assert!(Metal::by_name("Unobtainium").is_none());
    }

    #[test]
    fn gold_is_yellow_and_silver_is_grey() {
        let [gold, silver] = ["Au", "Ag"].map(|name| Metal::by_name(name).unwrap().reflectance(1.0));
        assert!(gold.r > gold.g && gold.g > 2.0 * gold.b - gold.g, "{gold:?}");
        assert!(silver.r - silver.b < 0.1, "{silver:?}");
    }
}
