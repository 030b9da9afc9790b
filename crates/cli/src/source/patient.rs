//! A pipe that may fall silent: reading it ends after a while instead of waiting for ever.

use std::io::{Cursor, Error, ErrorKind, Read, Result};
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::time::Duration;

/// Bytes that are read at once, and how many such pieces wait for their reader.
const PIECE: usize = 1 << 16;
const PIECES: usize = 16;

/// Reads in a thread, which ends with the pipe.
pub struct Patient {
    pieces: Receiver<Result<Vec<u8>>>,
    current: Cursor<Vec<u8>>,
    patience: Duration,
}

impl Patient {
    /// Gives up when nothing comes for so long.
    pub fn new(mut pipe: impl Read + Send + 'static, patience: Duration) -> Self {
        let (sender, pieces) = sync_channel(PIECES);
        std::thread::spawn(move || {
            loop {
                let mut piece = vec![0; PIECE];
                let read = pipe.read(&mut piece).map(|length| {
                    piece.truncate(length);
                    piece
                });
                let is_last = !matches!(&read, Ok(piece) if !piece.is_empty());
                if sender.send(read).is_err() || is_last {
                    break;
                }
            }
        });
        Patient {
            pieces,
            current: Cursor::new(Vec::new()),
            patience,
        }
    }
}

impl Read for Patient {
    fn read(&mut self, to: &mut [u8]) -> Result<usize> {
        if self.current.position() == self.current.get_ref().len() as u64 {
            self.current = Cursor::new(match self.pieces.recv_timeout(self.patience) {
                Ok(piece) => piece?,
                Err(RecvTimeoutError::Disconnected) => Vec::new(),
                Err(RecvTimeoutError::Timeout) => {
                    let seconds = self.patience.as_secs();
                    let message = format!("nothing came for {seconds} s");
                    return Err(Error::new(ErrorKind::TimedOut, message));
                }
            });
        }
        self.current.read(to)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write;
    use std::net::{TcpListener, TcpStream};

    #[test]
    fn a_silent_pipe_is_given_up_and_another_is_read_to_its_end() {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let mut sender = TcpStream::connect(listener.local_addr().unwrap()).unwrap();
        let (pipe, _) = listener.accept().unwrap();
        let mut patient = Patient::new(pipe, Duration::from_millis(200));
        let sent: Vec<u8> = (0..200_000u32).map(|i| i as u8).collect();
        sender.write_all(&sent).unwrap();
        let mut got = vec![0; sent.len()];
        patient.read_exact(&mut got).unwrap();
        assert_eq!(got, sent);
        let error = patient.read(&mut got).unwrap_err();
        assert_eq!(error.kind(), ErrorKind::TimedOut);
        drop(sender);
        assert_eq!(patient.read(&mut got).unwrap(), 0);
        assert_eq!(patient.read(&mut got).unwrap(), 0);
    }
}
