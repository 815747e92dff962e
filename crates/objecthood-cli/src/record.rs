//! The record of a run: a line of JSON for each frame that ended, by which a later run goes on.
//!
//! A line is written when all files of its frame have their names, so a process that is killed leaves at worst half a line, and a frame
//! whose files are there but whose line is not is done again.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use anyhow::{Result, anyhow};
use serde::{Deserialize, Serialize};

/// Its name in the folder for outputs.
pub(crate) const NAME: &str = "frames.jsonl";

/// How a frame ended.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Line {
    /// The file it is from, as the user named it.
    pub(crate) source: String,
    /// What decides the result, as [`objecthood_io::FrameRef::fingerprint`] has it; `None` when it failed, so that it is tried again.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) fingerprint: Option<String>,
    /// How many objects were found; `None` when it failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) objects: Option<usize>,
    /// Its files, from the folder for outputs. A name that is no text is not found again, so its frame is done again.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(crate) files: Vec<String>,
    /// Why it failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) error: Option<String>,
}

/// The first line. With other settings the outputs are replaced one by one, so what an earlier record says of them holds no more.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Head {
    /// SHA-256 of what decides the results beside the files.
    settings: String,
}

/// A record that grows.
pub(crate) struct Record {
    path: PathBuf,
    file: File,
}

/// What an earlier run has done: the places of the lines by fingerprint, so that a million frames take little memory.
pub(crate) struct Earlier {
    out: PathBuf,
    places: BTreeMap<String, u64>,
    lines: Mutex<BufReader<File>>,
}

impl Record {
    /// Begins a record in a folder, or goes on with the one that is there, if it has these settings; what that says.
    ///
    /// # Errors
    /// When it cannot be read or written.
    pub(crate) fn open(out: &Path, settings: &str, resume: bool) -> Result<(Earlier, Self)> {
        let path = out.join(NAME);
        let broken =
            |e| anyhow!("{}: cannot be used ({e}): check that you may read and write it", path.display());
        let mut options = OpenOptions::new();
        options.read(true).write(true).create(true).truncate(!resume);
        let mut file = options.open(&path).map_err(broken)?;
        let head = Head { settings: objecthood_io::sha256(settings.as_bytes()) };
        let (places, end) = places(&file, &head).map_err(broken)?;
        // Behind it there is half a line of a process that was killed, or what holds no more.
        file.set_len(end).and_then(|()| file.seek(SeekFrom::End(0))).map_err(broken)?;
        if end == 0 {
            writeln!(file, "{}", serde_json::to_string(&head)?).map_err(broken)?;
        }
        let lines = Mutex::new(BufReader::new(File::open(&path).map_err(broken)?));
        Ok((Earlier { out: out.to_owned(), places, lines }, Self { path, file }))
    }

    /// Removes the record.
    ///
    /// # Errors
    /// When the system does not let it.
    pub(crate) fn remove(self) -> Result<()> {
        std::fs::remove_file(&self.path)
            .map_err(|e| anyhow!("{}: cannot be removed ({e})", self.path.display()))
    }

    /// Adds a line.
    ///
    /// # Errors
    /// When it cannot be written.
    pub(crate) fn add(&mut self, line: &Line) -> Result<()> {
        let text = serde_json::to_string(line)? + "\n";
        let written = self.file.write_all(text.as_bytes());
        written.map_err(|e| anyhow!("{}: cannot be written ({e})", self.path.display()))
    }
}

impl Earlier {
    /// The number of objects of a frame that is done and whose files are all there.
    pub(crate) fn objects_of(&self, fingerprint: &str) -> Option<usize> {
        let &place = self.places.get(fingerprint)?;
        let mut text = String::new();
        {
            let mut lines = self.lines.lock().unwrap_or_else(PoisonError::into_inner);
            lines.seek(SeekFrom::Start(place)).ok()?;
            lines.read_line(&mut text).ok()?;
        }
        let line: Line = serde_json::from_str(&text).ok()?;
        line.files.iter().all(|file| self.out.join(file).is_file()).then_some(line.objects)?
    }
}

/// Where the lines of the frames that are done begin, by fingerprint, and where the last whole line ends (bytes). Nothing of a record with
/// another head.
fn places(file: &File, head: &Head) -> std::io::Result<(BTreeMap<String, u64>, u64)> {
    let (mut places, mut end) = (BTreeMap::new(), 0);
    let mut reader = BufReader::new(file);
    let mut text = Vec::new();
    reader.read_until(b'\n', &mut text)?;
    if !text.ends_with(b"\n") || serde_json::from_slice::<Head>(&text).ok().as_ref() != Some(head) {
        return Ok((places, 0));
    }
    end += text.len() as u64;
    text.clear();
    while reader.read_until(b'\n', &mut text)? > 0 && text.ends_with(b"\n") {
        if let Some(fingerprint) =
            serde_json::from_slice::<Line>(&text).ok().and_then(|line| line.fingerprint)
        {
            places.insert(fingerprint, end);
        }
        end += text.len() as u64;
        text.clear();
    }
    Ok((places, end))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(fingerprint: &str, objects: Option<usize>) -> Line {
        let error = objects.is_none().then(|| "broken".to_owned());
        let files = objects.iter().map(|_| format!("{fingerprint}.json")).collect();
        let fingerprint = objects.map(|_| fingerprint.to_owned());
        Line { source: "a.pcd".into(), fingerprint, objects, files, error }
    }

    #[test]
    fn what_is_whole_counts_and_the_rest_is_done_again() {
        let folder = tempfile::tempdir().unwrap();
        let (_, mut record) = Record::open(folder.path(), "a", false).unwrap();
        for (name, objects) in [("one", Some(1)), ("failed", None), ("two", Some(2)), ("lost", Some(3))] {
            record.add(&line(name, objects)).unwrap();
        }
        let path = folder.path().join(NAME);
        let whole = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, format!("{whole}{{\"source\": \"b")).unwrap();
        for name in ["one", "two"] {
            std::fs::write(folder.path().join(format!("{name}.json")), "").unwrap();
        }

        let (earlier, mut record) = Record::open(folder.path(), "a", true).unwrap();
        let found = ["one", "failed", "two", "lost", "other"].map(|name| earlier.objects_of(name));
        assert_eq!(found, [Some(1), None, Some(2), None, None]);
        record.add(&line("more", Some(4))).unwrap();
        let longer = std::fs::read_to_string(&path).unwrap();
        assert!(longer.starts_with(&whole) && longer.lines().count() == 6, "{longer}");

        for (settings, resume) in [("b", true), ("b", false)] {
            let (earlier, _) = Record::open(folder.path(), settings, resume).unwrap();
            assert_eq!(earlier.objects_of("one"), None);
            assert_eq!(std::fs::read_to_string(&path).unwrap().lines().count(), 1);
        }
    }
}
