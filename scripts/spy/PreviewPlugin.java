// Shows the pictures of PREVIEW in lcm-spy: a double click on the channel opens a window.
package vpslam;

import java.awt.event.ActionEvent;
import java.io.ByteArrayInputStream;
import java.io.IOException;
import javax.imageio.ImageIO;
import javax.swing.AbstractAction;
import javax.swing.Action;
import javax.swing.ImageIcon;
import javax.swing.JDesktopPane;
import javax.swing.JInternalFrame;
import javax.swing.JLabel;
import javax.swing.Timer;
import lcm.spy.ChannelData;
import lcm.spy.SpyPlugin;

public class PreviewPlugin implements SpyPlugin {
  private static final int REFRESH_MS = 100;

  @Override
  public boolean canHandle(long fingerprint) {
    return fingerprint == preview_t.LCM_FINGERPRINT;
  }

  @Override
  public Action getAction(JDesktopPane desktop, ChannelData channel) {
    return new AbstractAction("Show the picture") {
      @Override
      public void actionPerformed(ActionEvent event) {
        show(desktop, channel);
      }
    };
  }

  private static void show(JDesktopPane desktop, ChannelData channel) {
    JInternalFrame frame = new JInternalFrame(channel.name, true, true);
    JLabel label = new JLabel();
    frame.add(label);
    desktop.add(frame);
    Timer timer = new Timer(REFRESH_MS, null);
    timer.addActionListener(event -> {
      if (frame.isClosed()) {
        timer.stop();
        return;
      }
      if (!(channel.last instanceof preview_t)) return;
      preview_t preview = (preview_t) channel.last;
      try {
        label.setIcon(new ImageIcon(ImageIO.read(new ByteArrayInputStream(preview.jpeg))));
        frame.setTitle(channel.name + ", frame " + preview.frame_seq);
        if (!frame.isVisible()) {
          frame.pack();
          frame.setVisible(true);
        }
      } catch (IOException e) {
        frame.setTitle(channel.name + ": no picture");
      }
    });
    timer.start();
  }
}
