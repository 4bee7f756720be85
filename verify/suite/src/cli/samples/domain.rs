//! Domains as options: `disk:r=2`, `triangle:a=0/0,b=1/0,c=0/1`.

use verify::cube::Cube;
use verify::domain::{
    Directions, Disk, Interval, Parallelogram, SphericalRectangle, SphericalTriangle, Triangle,
};
use verify::error::InputError;

use super::subject::{Atom, OnCube, Pdf, Subject, on_domain};

/// The domains, for help and messages.
pub(super) const ACCEPTED: &str = "interval[:a=0,b=1], square, rectangle:low=X/Y,high=X/Y, cube:d=N, disk[:r=1], \
triangle:a=P,b=P,c=P, parallelogram:o=P,a=V,b=V, sphere, hemisphere, cone:angle=RADIANS, spherical-triangle:a=V,b=V,c=V, \
spherical-rectangle:corner=V,a=V,b=V";

/// A domain by name, with its parameters.
pub(super) struct Spec<'a> {
    name: &'a str,
    parameters: Vec<(&'a str, Vec<f64>)>,
}

impl<'a> Spec<'a> {
    /// Reads `NAME[:KEY=VALUE,…]`, where a value is a number or several with `/` between them.
    pub(super) fn parse(text: &'a str) -> Result<Self, String> {
        let (name, rest) = text.split_once(':').unwrap_or((text, ""));
        let parameter = |text: &'a str| {
            let (key, value) =
                text.split_once('=').ok_or_else(|| format!("{text:?}; KEY=VALUE is accepted"))?;
            Ok((key, numbers(value)?))
        };
        let parameters = rest.split(',').filter(|text| !text.is_empty()).map(parameter);
        Ok(Self { name, parameters: parameters.collect::<Result<_, String>>()? })
    }

    /// Number of coordinates of a point.
    pub(super) fn dimensions(&self) -> Result<usize, String> {
        Ok(match self.name {
            "interval" => 1,
            "square" | "rectangle" | "disk" => 2,
            "triangle" | "parallelogram" => match self.given("a").map_or(0, <[f64]>::len) {
                size @ (2 | 3) => size,
                _ => return Err(format!("{}: a of two or three coordinates is accepted", self.name)),
            },
            "sphere" | "hemisphere" | "cone" | "spherical-triangle" | "spherical-rectangle" => 3,
            "cube" => self.count("d")?,
            other => return Err(format!("{other}; {ACCEPTED} are accepted")),
        })
    }

    /// The test on it.
    pub(super) fn subject(&self, pdf: &Pdf, atoms: &[Atom]) -> Result<Box<dyn Subject>, String> {
        self.check_names()?;
        let with = (pdf, atoms);
        let made = |reason: InputError| format!("{}: {reason}", self.name);
        match (self.name, self.dimensions()?) {
            ("interval", _) => {
                let [a] = self.vector_or("a", [0.0])?;
                let [b] = self.vector_or("b", [1.0])?;
                on_domain(Interval::new(a, b).map_err(made)?, |[x]| x, |x| [x], with)
            }
            ("square", _) => on_domain(Parallelogram::unit_square(), |p| p, |p| p, with),
            ("rectangle", _) => {
                let rectangle = Parallelogram::rectangle(self.vector("low")?, self.vector("high")?);
                on_domain(rectangle.map_err(made)?, |p| p, |p| p, with)
            }
            ("disk", _) => {
                let [r] = self.vector_or("r", [1.0])?;
                on_domain(Disk::of_radius(positive("r", r)?), |p| p, |p| p, with)
            }
            ("triangle", 2) => self.triangle::<2>(with),
            ("triangle", _) => self.triangle::<3>(with),
            ("parallelogram", 2) => self.parallelogram::<2>(with),
            ("parallelogram", _) => self.parallelogram::<3>(with),
            ("sphere", _) => on_domain(Directions::sphere(), |p| p, |p| p, with),
            ("hemisphere", _) => on_domain(Directions::hemisphere(), |p| p, |p| p, with),
            ("cone", _) => {
                let [angle] = self.vector("angle")?;
                if !(angle > 0.0 && angle <= std::f64::consts::PI) {
                    return Err(format!("angle is {angle}; above 0 to π is accepted"));
                }
                on_domain(Directions::cone(angle), |p| p, |p| p, with)
            }
            ("spherical-triangle", _) => {
                let vertices = [self.vector("a")?, self.vector("b")?, self.vector("c")?];
                on_domain(SphericalTriangle::new(vertices).map_err(made)?, |p| p, |p| p, with)
            }
            ("spherical-rectangle", _) => {
                let edges = [self.vector("a")?, self.vector("b")?];
                let rectangle = SphericalRectangle::new(self.vector("corner")?, edges);
                on_domain(rectangle.map_err(made)?, |p| p, |p| p, with)
            }
            (_, dimensions) if *pdf == Pdf::Uniform && atoms.is_empty() => {
                Ok(Box::new(OnCube { cube: Cube::new(dimensions).map_err(made)?, dimensions }))
            }
            _ => Err(String::from("cube: only --pdf uniform without atoms is accepted")),
        }
    }

    fn triangle<const N: usize>(&self, with: (&Pdf, &[Atom])) -> Result<Box<dyn Subject>, String> {
        let vertices: [[f64; N]; 3] = [self.vector("a")?, self.vector("b")?, self.vector("c")?];
        let triangle = Triangle::new(vertices).map_err(|reason| format!("triangle: {reason}"))?;
        no_cosine(with.0)?;
        on_domain(triangle, |p| p, |p| p, with)
    }

    fn parallelogram<const N: usize>(&self, with: (&Pdf, &[Atom])) -> Result<Box<dyn Subject>, String> {
        let edges: [[f64; N]; 2] = [self.vector("a")?, self.vector("b")?];
        let parallelogram = Parallelogram::new(self.vector("o")?, edges);
        no_cosine(with.0)?;
        on_domain(parallelogram.map_err(|reason| format!("parallelogram: {reason}"))?, |p| p, |p| p, with)
    }

    /// Refuses parameters that the domain does not have.
    fn check_names(&self) -> Result<(), String> {
        let accepted: &[&str] = match self.name {
            "interval" => &["a", "b"],
            "rectangle" => &["low", "high"],
            "disk" => &["r"],
            "cube" => &["d"],
            "cone" => &["angle"],
            "triangle" | "spherical-triangle" => &["a", "b", "c"],
            "parallelogram" => &["o", "a", "b"],
            "spherical-rectangle" => &["corner", "a", "b"],
            _ => &[],
        };
        match self.parameters.iter().find(|(key, _)| !accepted.contains(key)) {
            Some((key, _)) if accepted.is_empty() => {
                Err(format!("{}: {key} is given; no parameter is accepted", self.name))
            }
            Some((key, _)) => {
                Err(format!("{}: {key} is given; {} are accepted", self.name, accepted.join(", ")))
            }
            None => Ok(()),
        }
    }

    fn given(&self, key: &str) -> Option<&[f64]> {
        self.parameters.iter().find(|(name, _)| *name == key).map(|(_, value)| value.as_slice())
    }

    fn vector<const N: usize>(&self, key: &str) -> Result<[f64; N], String> {
        let value =
            self.given(key).ok_or_else(|| format!("{} without {key}; {ACCEPTED} are accepted", self.name))?;
        let given = value.len();
        value.try_into().map_err(|_| format!("{key} has {given} numbers; {N} are accepted"))
    }

    fn vector_or<const N: usize>(&self, key: &str, default: [f64; N]) -> Result<[f64; N], String> {
        if self.given(key).is_some() { self.vector(key) } else { Ok(default) }
    }

    fn count(&self, key: &str) -> Result<usize, String> {
        let [value] = self.vector(key)?;
        (2..=verify::cube::MOST_DIMENSIONS)
            .find(|&count| count as f64 == value)
            .ok_or_else(|| format!("{key} is {value}; 2 to {} is accepted", verify::cube::MOST_DIMENSIONS))
    }
}

/// Reads numbers with `/` between them.
pub(super) fn numbers(text: &str) -> Result<Vec<f64>, String> {
    let number = |part: &str| match part.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(format!("{part:?}; a finite number is accepted")),
    };
    text.split('/').map(number).collect()
}

fn positive(key: &str, value: f64) -> Result<f64, String> {
    if value > 0.0 { Ok(value) } else { Err(format!("{key} is {value}; above 0 is accepted")) }
}

fn no_cosine(pdf: &Pdf) -> Result<(), String> {
    if *pdf == Pdf::Cosine {
        Err(String::from("--pdf cosine: domains of directions are accepted"))
    } else {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn subject(text: &str) -> Result<usize, String> {
        let spec = Spec::parse(text)?;
        spec.subject(&Pdf::Uniform, &[])?;
        spec.dimensions()
    }

    #[test]
    fn every_domain_is_made_by_name() {
        for (text, dimensions) in [
            ("interval", 1),
            ("interval:a=-1,b=2.5", 1),
            ("square", 2),
            ("rectangle:low=0/0,high=1/2", 2),
            ("cube:d=5", 5),
            ("disk", 2),
            ("disk:r=2", 2),
            ("triangle:a=0/0,b=1/0,c=0/1", 2),
            ("triangle:a=0/0/1,b=1/0/0,c=0/1/0", 3),
            ("parallelogram:o=0/0/1,a=1/0/0,b=0/1/0", 3),
            ("sphere", 3),
            ("hemisphere", 3),
            ("cone:angle=0.5", 3),
            ("spherical-triangle:a=1/0/0,b=0/1/0,c=0/0/1", 3),
            ("spherical-rectangle:corner=-1/-1/2,a=2/0/0,b=0/2/0", 3),
        ] {
            assert_eq!(subject(text), Ok(dimensions), "{text}");
        }
    }

    #[test]
    fn what_is_no_domain_is_refused_with_what_is_accepted() {
        for (text, part) in [
            ("disc", "disk"),
            ("disk:radius=2", "r are accepted"),
            ("disk:r=0", "above 0"),
            ("disk:r=x", "finite number"),
            ("disk:r", "KEY=VALUE"),
            ("cone", "without angle"),
            ("cube:d=1", "2 to 64"),
            ("square:a=1", "no parameter"),
            ("triangle:a=0/0,b=1/1,c=2/2", "squared area"),
            ("rectangle:low=0,high=1/1", "2 are accepted"),
        ] {
            assert!(
                subject(text).is_err_and(|message| message.contains(part)),
                "{text}: {:?}",
                subject(text)
            );
        }
        let cube = Spec::parse("cube:d=3").expect("a name and a parameter");
        assert!(cube.subject(&Pdf::Cosine, &[]).is_err());
        let disk = Spec::parse("disk").expect("a name");
        assert!(disk.subject(&Pdf::Cosine, &[]).is_err());
        let atom = Atom { place: vec![0.0; 3], probability: 0.5 };
        assert!(disk.subject(&Pdf::Uniform, &[atom]).is_err());
    }
}
