//! Metals, by their complex index of refraction or by name.

use super::color::color;
use super::object::Object;
use crate::Error;
use crate::materials::Metal;
use crate::math::Rgb;
use crate::math::spectrum::Kind;

/// Mitsuba's linear sRGB of its named conductors; a copy of `references/spectra/metals_rgb.csv`, whose README tells how it
/// was made.
const METALS: &str = include_str!("metals.csv");

/// The metal by `material` or by `eta` and `k`; `None` for a mirror.
pub(super) fn metal(object: &Object) -> Result<Option<Metal>, Error> {
    let material = object.string("material")?;
    let (eta, k) = (color(object, "eta", Kind::Index)?, color(object, "k", Kind::Index)?);
    let (eta, k) = match (material, eta, k) {
        (None, None, None) => return Ok(None),
        (None, Some(eta), Some(k)) => (eta, k),
        (Some(name), None, None) if name.value == "none" => return Ok(None),
        (Some(name), None, None) => named_metal(&name.value).ok_or_else(|| {
            let names: Vec<&str> = METALS.lines().skip(1).filter_map(|line| line.split(',').next()).collect();
            let list = names.join(", ");
            name.place.refuse(format!("'material' is '{}'; none, {list} are accepted", name.value))
        })?,
        _ => {
            return Err(object
                .place()
                .refuse("eta, k and material; both eta and k, or material alone, are accepted"));
        }
    };
    Metal::new(eta, k).map(Some).map_err(|reason| object.refuse(&reason))
}

fn named_metal(name: &str) -> Option<(Rgb, Rgb)> {
    let mut cells = METALS.lines().skip(1).map(|line| line.split(',')).find_map(|mut cells| {
        let found = cells.next() == Some(name);
        found.then_some(cells)
    })?;
    let mut next = || cells.next().and_then(|cell| cell.parse().ok());
    let eta = Rgb::new(next()?, next()?, next()?);
    Some((eta, Rgb::new(next()?, next()?, next()?)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_of_metals_is_the_references_table_and_all_can_be_used() {
        assert_eq!(METALS, include_str!("../../../../references/spectra/metals_rgb.csv"));
        for name in METALS.lines().skip(1).filter_map(|line| line.split(',').next()) {
            let (eta, k) = named_metal(name).unwrap();
            assert!(eta.is_finite() && k.is_finite(), "{name}");
        }
        assert_eq!(named_metal("Au").unwrap().0.g, 0.375_307_08);
    }
}
