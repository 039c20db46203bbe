//! Each room uses only those above it: the map of the crate docs, held against the imports.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

fn src() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

/// A file's text without its own tests, comments and strings of documentation.
fn code(path: &Path) -> String {
    let text = std::fs::read_to_string(path).unwrap();
    let text = text.split("#[cfg(test)]").next().unwrap_or("");
    let kept = text.lines().filter(|line| !line.trim_start().starts_with("//"));
    kept.map(|line| format!("{line}\n")).collect()
}

/// The rooms of the crate docs' table, from the top.
fn rooms() -> Vec<String> {
    let text = std::fs::read_to_string(src().join("lib.rs")).unwrap();
    let rows = text.lines().filter_map(|line| line.strip_prefix("//! | "));
    let rows = rows.filter(|row| row.starts_with("[`") || row.starts_with('`'));
    let cells = rows.filter_map(|row| row.split(" | ").next());
    cells
        .flat_map(|cell| cell.split(", ").map(|room| room.trim_matches(['[', ']', '`']).to_owned()))
        .collect()
}

/// The room of a file, and the file or folder of that room in which it stands.
fn room_of(path: &Path) -> String {
    let inside = path.strip_prefix(src()).unwrap();
    let first = inside.components().next().unwrap().as_os_str().to_string_lossy().into_owned();
    first.trim_end_matches(".rs").to_owned()
}

/// The paths after `crate::`, each of at most two names.
fn imports(code: &str) -> BTreeSet<Vec<String>> {
    let mut found = BTreeSet::new();
    for rest in code.split("crate::").skip(1) {
        let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':'));
        let path = &rest[..end.unwrap_or(rest.len())];
        let names: Vec<String> =
            path.split("::").filter(|n| !n.is_empty()).map(str::to_owned).collect();
        found.insert(names);
    }
    found
}

#[test]
fn every_room_is_on_the_map_and_uses_only_those_above_it() {
    let rooms = rooms();
    let place = |room: &str| rooms.iter().position(|r| r == room);
    let mut wrong = Vec::new();
    for path in sources(&src()) {
        let room = room_of(&path);
        if ["lib", "main", "cli"].contains(&room.as_str()) {
            continue;
        }
        let Some(own) = place(&room) else {
            wrong.push(format!("{room} is not in the table of lib.rs"));
            continue;
        };
        for names in imports(&code(&path)) {
            let used = names.first().and_then(|name| place(name));
            if used.is_some_and(|used| used > own) {
                wrong.push(format!("{} uses {}", path.display(), names.join("::")));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The module that a file is: `frames::exr_file`. A `mod.rs` is called after its folder.
fn module(path: &Path) -> String {
    let inside = path.strip_prefix(src()).unwrap().with_extension("");
    let names = inside.iter().map(|name| name.to_str().unwrap()).filter(|name| *name != "mod");
    names.collect::<Vec<_>>().join("::")
}

/// The paths that a module's code names, from the crate's root, with groups in braces spelt out.
fn paths(code: &str, module: &str) -> Vec<String> {
    let parent =
        module.rsplit_once("::").map_or(String::new(), |(parent, _)| format!("{parent}::"));
    let code = code.replace("super::", &format!("crate::{parent}"));
    let mut paths = Vec::new();
    for rest in code.split("crate::").skip(1) {
        let end = rest.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == ':'));
        let (path, rest) = rest.split_at(end.unwrap_or(rest.len()));
        let group = rest.strip_prefix('{').and_then(|rest| rest.split("};").next()).unwrap_or("");
        paths.extend(group.split(',').map(|name| format!("{path}{}", name.trim())));
    }
    paths
}

/// Whether one of them is a folder's `mod.rs` above the other: it declares what it uses.
fn are_kin(a: &str, b: &str) -> bool {
    a.starts_with(&format!("{b}::")) || b.starts_with(&format!("{a}::"))
}

#[test]
fn no_files_import_each_other_in_a_circle() {
    let files: BTreeMap<String, PathBuf> =
        sources(&src()).into_iter().map(|path| (module(&path), path)).collect();
    let of_path = |path: &str| {
        let inside = |module: &&String| path == *module || path.starts_with(&format!("{module}::"));
        files.keys().filter(inside).max_by_key(|module| module.len()).cloned()
    };
    let used = |module: &String| -> BTreeSet<String> {
        let found = paths(&code(&files[module]), module).into_iter().filter_map(|p| of_path(&p));
        found.filter(|other| other != module && !are_kin(other, module)).collect()
    };
    let mut left: BTreeMap<String, BTreeSet<String>> =
        files.keys().map(|module| (module.clone(), used(module))).collect();
    // Files that use none of those left, or that none of those left uses, are in no circle.
    let mut before = usize::MAX;
    while left.len() < before {
        before = left.len();
        let users: BTreeSet<String> = left.keys().cloned().collect();
        let all: BTreeSet<String> = left.values().flatten().cloned().collect();
        left.retain(|module, used| !used.is_disjoint(&users) && all.contains(module));
    }
    assert!(left.is_empty(), "these import each other: {left:#?}");
}
