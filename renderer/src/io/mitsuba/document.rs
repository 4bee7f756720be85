//! A scene file as a tree of elements with their places: inclusions read, parameters put in, ids known. Nothing here
//! knows a plugin.

use std::collections::BTreeMap;
use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use roxmltree::{Node, ParsingOptions};

use super::files::Files;
use crate::Error;

/// Elements may lie this deep in each other, included files too.
pub(super) const MAX_DEPTH: usize = 64;
/// A scene may include this many files; files that include each other in a tree would otherwise never end.
const MAX_FILES: usize = 1000;
/// An attribute may be this long after its parameters are put in; parameters made of parameters double in length.
const MAX_VALUE: usize = 1 << 20;

const TAGS: [&str; 25] = [
    "scene",
    "integrator",
    "sensor",
    "film",
    "sampler",
    "rfilter",
    "shape",
    "bsdf",
    "emitter",
    "texture",
    "ref",
    "float",
    "integer",
    "boolean",
    "string",
    "rgb",
    "spectrum",
    "point",
    "vector",
    "transform",
    "animation",
    "translate",
    "rotate",
    "scale",
    "lookat",
];

/// Where something is written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Place {
    file: Rc<Path>,
    line: u32,
    column: u32,
}

impl Place {
    /// The refusal of what is written here.
    pub(super) fn refuse(&self, message: impl Into<String>) -> Error {
        let message = message.into();
        Error::Format { path: self.file.to_path_buf(), line: self.line, column: self.column, message }
    }

    /// The refusal of something valid that is not built.
    pub(super) fn unsupported(&self, feature: impl Into<String>, accepted: impl Into<String>) -> Error {
        let (feature, accepted) = (feature.into(), accepted.into());
        let path = self.file.to_path_buf();
        Error::Unsupported { path, line: self.line, column: self.column, feature, accepted }
    }
}

impl Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}:{}:{}", self.file.display(), self.line, self.column)
    }
}

#[derive(Debug)]
pub(super) struct Attribute {
    pub(super) name: String,
    pub(super) value: String,
    pub(super) place: Place,
}

#[derive(Debug)]
pub(super) struct Element {
    pub(super) tag: String,
    pub(super) attributes: Vec<Attribute>,
    pub(super) children: Vec<usize>,
    pub(super) place: Place,
}

impl Element {
    pub(super) fn attribute(&self, name: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|a| a.name == name)
    }

    pub(super) fn text(&self, name: &str) -> Option<&str> {
        self.attribute(name).map(|a| a.value.as_str())
    }

    pub(super) fn required(&self, name: &str) -> Result<&Attribute, Error> {
        let missing = || self.place.refuse(format!("<{}> has no attribute '{name}'", self.tag));
        self.attribute(name).ok_or_else(missing)
    }

    /// Refuses attributes other than `accepted`.
    pub(super) fn only(&self, accepted: &[&str]) -> Result<(), Error> {
        match self.attributes.iter().find(|a| !accepted.contains(&a.name.as_str())) {
            Some(a) => {
                let list = accepted.join(", ");
                Err(a.place.refuse(format!("attribute '{}' of <{}>; {list} are accepted", a.name, self.tag)))
            }
            None => Ok(()),
        }
    }
}

/// All elements of a scene; `elements[0]` is its root.
#[derive(Debug, Default)]
pub(super) struct Document {
    pub(super) elements: Vec<Element>,
    ids: BTreeMap<String, usize>,
}

impl Document {
    /// The element that `id` names.
    pub(super) fn find(&self, id: &Attribute) -> Result<usize, Error> {
        self.ids.get(&id.value).copied().ok_or_else(|| {
            let known: Vec<&str> = self.ids.keys().map(String::as_str).collect();
            id.place.refuse(format!("no object has the id '{}'; {}", id.value, accepted(&known)))
        })
    }

    fn name(&mut self, id: &str, element: usize, place: &Place) -> Result<(), Error> {
        if let Some(&other) = self.ids.get(id) {
            let first = &self.elements[other].place;
            return Err(place.refuse(format!("id '{id}' is taken by {first}; an id of its own is accepted")));
        }
        self.ids.insert(id.into(), element);
        Ok(())
    }
}

/// "a, b and c are accepted", for any number of names.
pub(super) fn accepted(names: &[&str]) -> String {
    match names {
        [] => "nothing is accepted".into(),
        [one] => format!("{one} is accepted"),
        _ => format!("{} are accepted", names.join(", ")),
    }
}

/// A named value that stands for `$name` in attributes.
struct Parameter {
    name: String,
    value: String,
    used: bool,
}

struct Loader<'f> {
    files: &'f mut Files,
    parameters: Vec<Parameter>,
    document: Document,
    aliases: Vec<Element>,
    open: Vec<PathBuf>,
    included: usize,
}

/// Reads the scene `path` and all that it includes.
///
/// * `overrides`: parameters that win over the file's `default`s.
///
/// # Errors
/// `Error::Io` for `path` itself; `Error::Format` with the place for everything else.
pub(super) fn load(
    files: &mut Files,
    path: &Path,
    overrides: &[(String, String)],
) -> Result<Document, Error> {
    let given = |(name, value): &(String, String)| Parameter {
        name: name.clone(),
        value: value.clone(),
        used: false,
    };
    let parameters = overrides.iter().rev().map(given).collect();
    let bytes = files.read(path).map_err(|source| Error::Io { path: path.into(), source })?;
    let document = Document::default();
    let mut loader =
        Loader { files, parameters, document, aliases: Vec::new(), open: Vec::new(), included: 0 };
    loader.file(path, &bytes, None)?;
    loader.resolve_aliases()?;
    loader.check_overrides(path, overrides)?;
    Ok(loader.document)
}

/// Turns offsets of a file's text into places.
struct Source<'t> {
    file: Rc<Path>,
    text: &'t str,
    /// Whether each byte is a character, which need not be counted then: a file may be one long line.
    is_ascii: bool,
    lines: Vec<usize>,
}

impl Source<'_> {
    fn place(&self, offset: usize) -> Place {
        let line = self.lines.partition_point(|&start| start <= offset);
        let start = self.lines[line - 1];
        let before = self.text.get(start..offset).unwrap_or_default();
        let column = if self.is_ascii { before.len() } else { before.chars().count() } + 1;
        let number = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        Place { file: self.file.clone(), line: number(line), column: number(column) }
    }
}

impl Loader<'_> {
    /// Adds the elements of a file; those inside `parent`'s file's root go to `parent`.
    fn file(&mut self, path: &Path, bytes: &[u8], parent: Option<usize>) -> Result<(), Error> {
        let file: Rc<Path> = path.into();
        let whole = |line, column| Place { file: file.clone(), line, column };
        let text =
            std::str::from_utf8(bytes).map_err(|_| whole(0, 0).refuse("not UTF-8; XML text is accepted"))?;
        let options =
            ParsingOptions { allow_dtd: false, nodes_limit: 10_000_000, ..ParsingOptions::default() };
        let xml = roxmltree::Document::parse_with_options(text, options).map_err(|error| {
            let at = error.pos();
            whole(at.row, at.col).refuse(format!("{error}; well-formed XML is accepted"))
        })?;
        let starts = text.bytes().enumerate().filter(|&(_, b)| b == b'\n').map(|(i, _)| i + 1);
        let lines = std::iter::once(0).chain(starts).collect();
        let source = Source { file: file.clone(), text, is_ascii: text.is_ascii(), lines };
        self.open.push(path.canonicalize().unwrap_or_else(|_| path.into()));
        let root = xml.root_element();
        match parent {
            Some(parent) if root.has_tag_name("scene") => self.children(root, &source, parent, 0)?,
            Some(parent) => self.child(root, &source, parent, 0)?,
            None => {
                self.element(root, &source, 0)?;
            }
        }
        self.open.pop();
        Ok(())
    }

    fn children(&mut self, node: Node, source: &Source, parent: usize, depth: usize) -> Result<(), Error> {
        for child in node.children() {
            if child.is_element() {
                self.child(child, source, parent, depth)?;
            } else if child.is_text() && !child.text().unwrap_or("").trim().is_empty() {
                let place = source.place(child.range().start);
                return Err(place.refuse("text between elements; elements and comments are accepted"));
            }
        }
        Ok(())
    }

    fn child(&mut self, node: Node, source: &Source, parent: usize, depth: usize) -> Result<(), Error> {
        match node.tag_name().name() {
            "default" => self.default(node, source),
            "include" => self.include(node, source, parent),
            "alias" => {
                let alias = self.attributes(node, source)?;
                alias.only(&["id", "as"])?;
                self.aliases.push(alias);
                Ok(())
            }
            _ => {
                let index = self.element(node, source, depth + 1)?;
                self.document.elements[parent].children.push(index);
                Ok(())
            }
        }
    }

    fn element(&mut self, node: Node, source: &Source, depth: usize) -> Result<usize, Error> {
        let element = self.attributes(node, source)?;
        let (tag, place) = (element.tag.as_str(), element.place.clone());
        if !TAGS.contains(&tag) && tag != "matrix" {
            let also = "default, include, alias, matrix";
            return Err(place.refuse(format!("element <{tag}>; {}, {also} are accepted", TAGS.join(", "))));
        }
        if depth > MAX_DEPTH {
            return Err(place.refuse(format!("elements nested too deep; {MAX_DEPTH} levels are accepted")));
        }
        let id = element.text("id").filter(|_| tag != "ref").map(str::to_string);
        let index = self.document.elements.len();
        self.document.elements.push(element);
        if let Some(id) = id {
            self.document.name(&id, index, &place)?;
        }
        self.children(node, source, index, depth)?;
        Ok(index)
    }

    fn attributes(&mut self, node: Node, source: &Source) -> Result<Element, Error> {
        let mut attributes = Vec::new();
        for attribute in node.attributes() {
            let place = source.place(attribute.range().start);
            let value = self.substitute(attribute.value(), &place)?;
            attributes.push(Attribute { name: attribute.name().into(), value, place });
        }
        let tag = node.tag_name().name().to_string();
        Ok(Element { tag, attributes, children: Vec::new(), place: source.place(node.range().start) })
    }

    /// `text` with each `$name` replaced by the parameter with the longest name that fits.
    fn substitute(&mut self, text: &str, place: &Place) -> Result<String, Error> {
        let mut parts = text.split('$');
        let mut result = parts.next().unwrap_or("").to_string();
        for part in parts {
            let fits = self.parameters.iter_mut().filter(|p| !p.name.is_empty() && part.starts_with(&p.name));
            let Some(parameter) = fits.max_by_key(|p| p.name.len()) else {
                let name: String = part.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
                let known: Vec<String> = self.parameters.iter().map(|p| format!("${}", p.name)).collect();
                let known: Vec<&str> = known.iter().map(String::as_str).collect();
                return Err(place.refuse(format!("parameter ${name} has no value; {}", accepted(&known))));
            };
            parameter.used = true;
            result.push_str(&parameter.value);
            result.push_str(&part[parameter.name.len()..]);
            if result.len() > MAX_VALUE {
                return Err(
                    place.refuse(format!("a value longer than {MAX_VALUE} bytes; a shorter one is accepted"))
                );
            }
        }
        Ok(result)
    }

    fn default(&mut self, node: Node, source: &Source) -> Result<(), Error> {
        let element = self.attributes(node, source)?;
        element.only(&["name", "value"])?;
        let (name, value) = (element.required("name")?, element.required("value")?);
        if name.value.is_empty() {
            return Err(name.place.refuse("an empty name; a name of at least one character is accepted"));
        }
        match self.parameters.iter_mut().find(|p| p.name == name.value) {
            Some(known) => known.used = true,
            None => {
                let (name, value) = (name.value.clone(), value.value.clone());
                self.parameters.push(Parameter { name, value, used: false });
            }
        }
        Ok(())
    }

    fn include(&mut self, node: Node, source: &Source, parent: usize) -> Result<(), Error> {
        let element = self.attributes(node, source)?;
        element.only(&["filename"])?;
        let filename = element.required("filename")?;
        let path = self.files.resolve(&filename.value);
        let canonical = path.canonicalize().unwrap_or_else(|_| path.clone());
        if self.open.contains(&canonical) {
            let chain: Vec<String> = self.open.iter().map(|p| p.display().to_string()).collect();
            let chain = chain.join(" → ");
            return Err(filename.place.refuse(format!("include loop: {chain} → {}", canonical.display())));
        }
        self.included += 1;
        if self.open.len() >= MAX_DEPTH || self.included > MAX_FILES {
            let accepted = format!("up to {MAX_FILES} files, nested up to {MAX_DEPTH} deep, are accepted");
            return Err(filename.place.refuse(format!("too many inclusions; {accepted}")));
        }
        let missing = |error| filename.place.refuse(format!("filename '{}': {error}", filename.value));
        let bytes = self.files.read(&path).map_err(missing)?;
        self.file(&path, &bytes, Some(parent))
    }

    fn resolve_aliases(&mut self) -> Result<(), Error> {
        for alias in std::mem::take(&mut self.aliases) {
            let target = self.document.find(alias.required("id")?)?;
            let name = alias.required("as")?;
            self.document.name(&name.value, target, &name.place)?;
        }
        Ok(())
    }

    fn check_overrides(&self, path: &Path, overrides: &[(String, String)]) -> Result<(), Error> {
        let unused = |name: &str| self.parameters.iter().any(|p| p.name == name && !p.used);
        let wrong = overrides.iter().find(|(name, _)| name.is_empty() || unused(name));
        let Some((name, _)) = wrong else { return Ok(()) };
        let given = |p: &&Parameter| overrides.iter().all(|(name, _)| *name != p.name);
        let known: Vec<&str> = self.parameters.iter().filter(given).map(|p| p.name.as_str()).collect();
        let place = Place { file: path.into(), line: 0, column: 0 };
        Err(place.refuse(format!("-D{name}: the scene has no parameter '{name}'; {}", accepted(&known))))
    }
}
