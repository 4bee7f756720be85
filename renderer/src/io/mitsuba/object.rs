//! One object of a scene: a plugin with parameters, each of which is asked for once by name and kind. What has been asked
//! for is what is accepted, and what nobody asked for is refused.

use std::cell::RefCell;

use glam::DVec3;

use super::Context;
use super::document::{Attribute, Document, Element, Place, accepted};
use crate::{Error, ParamError};

/// An object and which of its parts have been asked for.
pub(super) struct Object<'d> {
    pub(super) context: &'d Context,
    pub(super) index: usize,
    pub(super) element: &'d Element,
    used: RefCell<Vec<usize>>,
    asked: RefCell<Vec<String>>,
}

const NESTED: [&str; 10] =
    ["scene", "integrator", "sensor", "film", "sampler", "rfilter", "shape", "bsdf", "emitter", "texture"];

impl<'d> Object<'d> {
    /// The object at `index` of the document.
    pub(super) fn new(context: &'d Context, index: usize) -> Result<Self, Error> {
        let element = &context.document.elements[index];
        element.only(&["type", "id", "name", "version"])?;
        Ok(Self { context, index, element, used: RefCell::default(), asked: RefCell::default() })
    }

    /// The plugin, one of `known`.
    pub(super) fn plugin(&self, known: &[&str]) -> Result<&'d str, Error> {
        let plugin = self.element.required("type")?;
        if known.contains(&plugin.value.as_str()) {
            return Ok(&plugin.value);
        }
        let feature = format!("{} plugin '{}'", self.element.tag, plugin.value);
        Err(plugin.place.unsupported(feature, accepted(known)))
    }

    /// How messages name it.
    pub(super) fn name(&self) -> String {
        let kind = self.element.text("type").unwrap_or("");
        let id = self.element.text("id").map(|id| format!(" '{id}'")).unwrap_or_default();
        format!("{}: {} {kind}{id}", self.element.place, self.element.tag)
    }

    /// Where it is.
    pub(super) fn place(&self) -> &'d Place {
        &self.element.place
    }

    /// What `reason` says, at the parameter of that name if there is one.
    pub(super) fn refuse(&self, reason: &ParamError) -> Error {
        let name = match reason {
            ParamError::NotFinite { name, .. }
            | ParamError::OutOfRange { name, .. }
            | ParamError::Singular { name, .. }
            | ParamError::Empty { name, .. }
            | ParamError::Index { name, .. } => *name,
        };
        let named = |&&child: &&usize| self.document().elements[child].text("name") == Some(name);
        let place =
            self.element.children.iter().find(named).map(|&child| &self.document().elements[child].place);
        let (tag, plugin) = (&self.element.tag, self.element.text("type").unwrap_or(""));
        place.unwrap_or(self.place()).refuse(format!("{tag} {plugin}: {reason}"))
    }

    fn document(&self) -> &'d Document {
        &self.context.document
    }

    /// Whether the object has a part called `name`.
    pub(super) fn has(&self, name: &str) -> bool {
        self.element.children.iter().any(|&child| self.document().elements[child].text("name") == Some(name))
    }

    /// The part called `name`, which must be one of `tags`; references are followed.
    pub(super) fn part(&self, name: &str, tags: &[&str]) -> Result<Option<usize>, Error> {
        self.asked.borrow_mut().push(name.into());
        let mut found = None;
        for &child in &self.element.children {
            let element = &self.document().elements[child];
            if element.text("name") != Some(name) {
                continue;
            }
            if found.is_some() {
                return Err(element.place.refuse(format!("'{name}' for the second time; once is accepted")));
            }
            self.used.borrow_mut().push(child);
            found = Some((self.follow(child)?, &element.place));
        }
        let Some((target, place)) = found else { return Ok(None) };
        let tag = self.document().elements[target].tag.as_str();
        if !tags.contains(&tag) {
            return Err(place.refuse(format!("'{name}' as <{tag}>; <{}> is accepted", tags.join(">, <"))));
        }
        Ok(Some(target))
    }

    fn value(&self, name: &str, tags: &[&str]) -> Result<Option<&'d Attribute>, Error> {
        let Some(index) = self.part(name, tags)? else { return Ok(None) };
        let element = &self.document().elements[index];
        element.only(&["name", "value"])?;
        element.required("value").map(Some)
    }

    fn follow(&self, child: usize) -> Result<usize, Error> {
        let element = &self.document().elements[child];
        if element.tag != "ref" {
            return Ok(child);
        }
        element.only(&["name", "id"])?;
        self.document().find(element.required("id")?)
    }

    /// The nested objects with `tag` that are not named parameters asked for before; references are followed.
    pub(super) fn nested(&self, tag: &str) -> Result<Vec<usize>, Error> {
        self.asked.borrow_mut().push(format!("<{tag}>"));
        let mut found = Vec::new();
        for &child in &self.element.children {
            let is_object = |t: &str| t == "ref" || NESTED.contains(&t);
            if !is_object(&self.document().elements[child].tag) || self.used.borrow().contains(&child) {
                continue;
            }
            let target = self.follow(child)?;
            if self.document().elements[target].tag == tag {
                self.used.borrow_mut().push(child);
                found.push(target);
            }
        }
        Ok(found)
    }

    /// The only nested object with `tag`.
    pub(super) fn only_nested(&self, tag: &str) -> Result<Option<usize>, Error> {
        match self.nested(tag)?[..] {
            [] => Ok(None),
            [one] => Ok(Some(one)),
            [_, second, ..] => {
                let place = &self.document().elements[second].place;
                Err(place.refuse(format!("a second <{tag}> in {}; one is accepted", self.element.tag)))
            }
        }
    }

    /// A finite number.
    pub(super) fn float(&self, name: &str) -> Result<Option<f64>, Error> {
        self.value(name, &["float", "integer"])?.map(number).transpose()
    }

    /// A whole number.
    pub(super) fn integer(&self, name: &str) -> Result<Option<i64>, Error> {
        let parse = |a: &Attribute| {
            let refuse = |_| a.place.refuse(format!("'{name}' is '{}'; a whole number is accepted", a.value));
            a.value.trim().parse().map_err(refuse)
        };
        self.value(name, &["integer"])?.map(parse).transpose()
    }

    /// A whole number in `range`, or `default`.
    pub(super) fn count(&self, name: &str, range: [u32; 2], default: u32) -> Result<u32, Error> {
        let Some(value) = self.integer(name)? else { return Ok(default) };
        let inside = u32::try_from(value).ok().filter(|v| (range[0]..=range[1]).contains(v));
        inside.ok_or_else(|| {
            self.refuse_value(name, format!("'{name}' is {value}; {} to {} is accepted", range[0], range[1]))
        })
    }

    /// True or false, or `default`.
    pub(super) fn boolean(&self, name: &str, default: bool) -> Result<bool, Error> {
        match self.value(name, &["boolean"])? {
            None => Ok(default),
            Some(a) => match a.value.trim().to_ascii_lowercase().as_str() {
                "true" => Ok(true),
                "false" => Ok(false),
                other => Err(a.place.refuse(format!("'{name}' is '{other}'; true, false are accepted"))),
            },
        }
    }

    /// A text.
    pub(super) fn string(&self, name: &str) -> Result<Option<&'d Attribute>, Error> {
        self.value(name, &["string"])
    }

    /// One of `choices` by its name, or `default`.
    pub(super) fn choice<T: Copy>(&self, name: &str, choices: &[(&str, T)], default: T) -> Result<T, Error> {
        let Some(a) = self.string(name)? else { return Ok(default) };
        let found = choices.iter().find(|(choice, _)| *choice == a.value);
        let names: Vec<&str> = choices.iter().map(|(choice, _)| *choice).collect();
        found
            .map(|(_, value)| *value)
            .ok_or_else(|| a.place.refuse(format!("'{name}' is '{}'; {}", a.value, accepted(&names))))
    }

    /// A point or a vector.
    pub(super) fn point(&self, name: &str) -> Result<Option<DVec3>, Error> {
        let Some(index) = self.part(name, &["point", "vector"])? else { return Ok(None) };
        let element = &self.document().elements[index];
        element.only(&["name", "value", "x", "y", "z"])?;
        if element.text("value").is_some() {
            return triple(element, "value").map(Some);
        }
        let [x, y, z] = ["x", "y", "z"].map(|axis| element.required(axis).and_then(number));
        Ok(Some(DVec3::new(x?, y?, z?)))
    }

    /// Asks for a parameter that may be there and changes nothing, with one note why.
    pub(super) fn without_effect(&self, name: &str, tags: &[&str], why: &str) -> Result<(), Error> {
        let Some(index) = self.part(name, tags)? else { return Ok(()) };
        let element = &self.document().elements[index];
        if matches!(tags[0], "float" | "integer") {
            number(element.required("value")?)?;
        }
        self.context.note(format!("{}: '{name}' has no effect: {why}", element.place));
        Ok(())
    }

    /// A refusal at the parameter `name`.
    pub(super) fn refuse_value(&self, name: &str, message: impl Into<String>) -> Error {
        let named = |&&child: &&usize| self.document().elements[child].text("name") == Some(name);
        let child = self.element.children.iter().find(named);
        child.map_or(self.place(), |&child| &self.document().elements[child].place).refuse(message)
    }

    /// The error that the parameter `name` is missing.
    pub(super) fn missing(&self, name: &str) -> Error {
        let (tag, plugin) = (&self.element.tag, self.element.text("type").unwrap_or(""));
        self.place().refuse(format!("{tag} {plugin} has no '{name}'; it must be given"))
    }

    /// Refuses what nobody asked for.
    pub(super) fn finish(self) -> Result<(), Error> {
        let used = self.used.borrow();
        let Some(&child) = self.element.children.iter().find(|child| !used.contains(child)) else {
            return Ok(());
        };
        let element = &self.document().elements[child];
        let name = element.text("name").or(element.text("id")).map(|n| format!(" '{n}'")).unwrap_or_default();
        let plugin = self.element.text("type").map(|p| format!(" {p}")).unwrap_or_default();
        let asked = self.asked.borrow();
        let mut list: Vec<&str> = asked.iter().map(String::as_str).collect();
        list.sort_unstable();
        list.dedup();
        let (tag, parent) = (&element.tag, &self.element.tag);
        Err(element.place.refuse(format!("unknown <{tag}>{name} in {parent}{plugin}; {}", accepted(&list))))
    }
}

/// The finite number that an attribute holds.
pub(super) fn number(a: &Attribute) -> Result<f64, Error> {
    let parsed = a.value.trim().parse().ok().filter(|v: &f64| v.is_finite());
    parsed.ok_or_else(|| a.place.refuse(format!("{} is '{}'; a finite number is accepted", a.name, a.value)))
}

/// The finite numbers that an attribute holds, between commas or blanks.
pub(super) fn numbers(a: &Attribute) -> Result<Vec<f64>, Error> {
    let words = a.value.split(|c: char| c == ',' || c.is_whitespace()).filter(|w| !w.is_empty());
    let parse = |word: &str| word.parse().ok().filter(|v: &f64| v.is_finite());
    words.map(parse).collect::<Option<Vec<f64>>>().ok_or_else(|| {
        a.place.refuse(format!(
            "{} is '{}'; finite numbers between commas or blanks are accepted",
            a.name, a.value
        ))
    })
}

/// Three numbers, or one for all three.
pub(super) fn triple(element: &Element, name: &str) -> Result<DVec3, Error> {
    let a = element.required(name)?;
    match numbers(a)?[..] {
        [x] => Ok(DVec3::splat(x)),
        [x, y, z] => Ok(DVec3::new(x, y, z)),
        ref other => {
            Err(a.place.refuse(format!("{name} of {} numbers; one or three are accepted", other.len())))
        }
    }
}
